// Alert rules and the dashboard ask for metrics that a server really exports.
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "tests/integration/service/metrics_fixture.h"
#include "tests/support/certificates.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

// Over TLS, so that there is a certificate to watch.
class ExportedNamesTest : public MetricsTest {
 protected:
  ExportedNamesTest() {
    const Authority authority("maploc test");
    const Issued issued = authority.Issue("IP:127.0.0.1");
    folder_.Write("server.crt", issued.cert);
    folder_.Write("server.key", issued.key);
    options_.tls = {folder_.File("server.crt"), folder_.File("server.key"), ""};
    RestartServer();
    ClientOptions client;
    client.credentials.ca_pem = authority.ca();
    client_ = std::make_unique<Client>(Address(), client);
  }

  // What becomes a metric when it happens.
  void LetEverythingHappen() {
    const SessionId session = StartSession();
    EXPECT_TRUE(client_->Localize(QueryAt(8.0, session)).ok());
    Query wrong = QueryAt(8.0);
    wrong.gravity = Gravity{Eigen::Vector3d(1, 0, 0), 0.01};
    EXPECT_TRUE(client_->Localize(wrong).ok());
    EXPECT_FALSE(client_->Localize(QueryAt(8.0, "no such session")).ok());
  }

  // Of the samples, without what a histogram adds.
  std::set<std::string> Exported() const {
    std::set<std::string> names;
    for (const auto& [sample, value] : Scrape()) {
      names.insert(std::regex_replace(sample.substr(0, sample.find('{')), kParts, ""));
    }
    return names;
  }
  static std::set<std::string> AskedFor(const std::string& file) {
    const std::string text = ReadFile(std::string(MAPLOC_SOURCE_DIR) + "/docker/" + file);
    const std::regex name("maploc_[a-z_]+");
    std::set<std::string> names;
    for (auto found = std::sregex_iterator(text.begin(), text.end(), name);
         found != std::sregex_iterator(); ++found) {
      names.insert(std::regex_replace(found->str(), kParts, ""));
    }
    return names;
  }

  static inline const std::regex kParts{"_(bucket|sum|count)$"};
};

TEST_F(ExportedNamesTest, RulesAndDashboardAskForNoOthers) {
  LetEverythingHappen();
  const std::set<std::string> exported = Exported();
  for (const char* file : {"prometheus/alerts.yaml", "grafana/maploc.json"}) {
    const std::set<std::string> asked = AskedFor(file);
    EXPECT_GE(asked.size(), 8u) << file;
    for (const std::string& name : asked) {
      EXPECT_TRUE(exported.contains(name)) << file << " asks for " << name;
    }
  }
}

TEST_F(ExportedNamesTest, TheDashboardShowsAllThatIsExported) {
  LetEverythingHappen();
  const std::set<std::string> shown = AskedFor("grafana/maploc.json");
  for (const std::string& name : Exported()) EXPECT_TRUE(shown.contains(name)) << name;
}

TEST_F(ExportedNamesTest, TheEndOfARenewedCertificateIsSeen) {
  const auto end = [this] { return Scrape()["maploc_tls_certificate_end_timestamp_seconds"]; };
  const double now = static_cast<double>(std::time(nullptr));
  EXPECT_NEAR(end(), now + 3600, 60);
  const Authority authority("maploc test");
  const Issued renewed = authority.Issue("IP:127.0.0.1", {-3600, 7200});
  folder_.Write("server.crt", renewed.cert);
  folder_.Write("server.key", renewed.key);
  ClientOptions client;
  client.credentials.ca_pem = authority.ca();
  EXPECT_TRUE(WaitFor([&] { return Client(Address(), client).ListMaps().ok(); }));
  EXPECT_NEAR(end(), now + 7200, 60);
}

}  // namespace
}  // namespace maploc::testing
