// A server whose metrics a test scrapes.
#pragma once

#include <map>
#include <sstream>
#include <string>

#include <civetweb.h>

#include "tests/integration/service/service_fixture.h"

namespace maploc::testing {

struct HttpAnswer {
  int code = 0;
  std::string body;
};

class MetricsTest : public ServiceTest {
 protected:
  MetricsTest() {
    options_.metrics_listen = "127.0.0.1:0";
    RestartServer();
  }

  HttpAnswer Get(const std::string& path) const {
    char error[256] = {};
    mg_connection* connection =
        mg_download("127.0.0.1", server_->metrics_port(), 0, error, sizeof error,
                    "GET %s HTTP/1.0\r\nHost: localhost\r\n\r\n", path.c_str());
    if (connection == nullptr) return {0, error};
    HttpAnswer answer{mg_get_response_info(connection)->status_code, ""};
    char buffer[4096];
    for (int read; (read = mg_read(connection, buffer, sizeof buffer)) > 0;) {
      answer.body.append(buffer, static_cast<std::size_t>(read));
    }
    mg_close_connection(connection);
    return answer;
  }

  // The samples by name and labels, as they are written.
  std::map<std::string, double> Scrape() const {
    const HttpAnswer answer = Get("/metrics");
    EXPECT_EQ(answer.code, 200) << answer.body;
    std::map<std::string, double> samples;
    std::istringstream lines(answer.body);
    for (std::string line; std::getline(lines, line);) {
      const std::size_t space = line.rfind(' ');
      if (line.empty() || line[0] == '#' || space == std::string::npos) continue;
      samples[line.substr(0, space)] = std::stod(line.substr(space + 1));
    }
    return samples;
  }
};

}  // namespace maploc::testing
