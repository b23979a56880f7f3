#include "server/app/metrics_listener.h"

#include <utility>
#include <vector>

#include <CivetServer.h>

namespace maploc {
namespace {

// Each request takes one; those who send nothing keep theirs until the timeout. With four threads
// and 5 s, 30 of them kept a probe of the health waiting for 35 s.
constexpr char kThreads[] = "32";
constexpr char kTimeoutMs[] = "2000";

void Answer(mg_connection* connection, int code, const char* reason, const char* type,
            const std::string& body) {
  mg_printf(connection,
            "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\n"
            "Cache-Control: no-store\r\nConnection: close\r\n\r\n",
            code, reason, type, body.size());
  mg_write(connection, body.data(), body.size());
}

class MetricsPage : public CivetHandler {
 public:
  explicit MetricsPage(std::function<std::string()> text) : text_(std::move(text)) {}

  bool handleGet(CivetServer*, mg_connection* connection) override {
    Answer(connection, 200, "OK", "text/plain; version=0.0.4; charset=utf-8", text_());
    return true;
  }

 private:
  const std::function<std::string()> text_;
};

class HealthPage : public CivetHandler {
 public:
  explicit HealthPage(std::function<bool()> healthy) : healthy_(std::move(healthy)) {}

  bool handleGet(CivetServer*, mg_connection* connection) override {
    const bool healthy = healthy_();
    Answer(connection, healthy ? 200 : 503, healthy ? "OK" : "Service Unavailable", "text/plain",
           healthy ? "SERVING\n" : "NOT_SERVING\n");
    return true;
  }

 private:
  const std::function<bool()> healthy_;
};

std::vector<std::string> HttpOptions(const std::string& address) {
  return {"listening_ports",    address,    "num_threads",       kThreads,
          "request_timeout_ms", kTimeoutMs, "enable_keep_alive", "no"};
}

}  // namespace

struct MetricsListener::Impl {
  Impl(const std::string& address, Content content)
      : metrics(std::move(content.metrics)),
        health(std::move(content.healthy)),
        server(HttpOptions(address)) {
    // Without the $ civetweb would give a page also for every address below it.
    server.addHandler("/metrics$", metrics);
    server.addHandler("/healthz$", health);
  }

  MetricsPage metrics;
  HealthPage health;
  CivetServer server;  // last: its threads use the pages
};

Result<std::unique_ptr<MetricsListener>> MetricsListener::Start(const std::string& address,
                                                                Content content) {
  try {
    return std::unique_ptr<MetricsListener>(
        new MetricsListener(std::make_unique<Impl>(address, std::move(content))));
  } catch (const CivetException& error) {
    return Status(StatusCode::kUnavailable, "CANNOT_LISTEN",
                  "cannot listen on --metrics-listen " + address + " (" + error.what() +
                      "): another program has the port, or this machine has no such address; "
                      "choose another one");
  }
}

MetricsListener::MetricsListener(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

MetricsListener::~MetricsListener() = default;

int MetricsListener::port() const { return impl_->server.getListeningPorts().front(); }

}  // namespace maploc
