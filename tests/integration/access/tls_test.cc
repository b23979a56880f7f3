// Who gets a connection: certificates that fit and those that do not, on both sides.
#include "tests/integration/access/access_fixture.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

class TlsTest : public AccessTest {};

constexpr char kHere[] = "IP:127.0.0.1";

TEST_F(TlsTest, AClientThatBelievesTheAuthorityIsAnswered) {
  GiveServer(authority_.Issue(kHere));
  StartServer();
  const Result<std::vector<RemoteMap>> maps = Connect(Believing(authority_)).ListMaps();
  ASSERT_TRUE(maps.ok()) << maps.status().ToString();
  EXPECT_EQ(maps->size(), 1u);
}

TEST_F(TlsTest, AForeignAuthorityAnotherHostAndPlainTextGetNoConnection) {
  GiveServer(authority_.Issue(kHere));
  StartServer();
  EXPECT_EQ(Connect(Believing(foreign_)).ListMaps().status().code(), StatusCode::kUnavailable);
  EXPECT_EQ(Connect().ListMaps().status().code(), StatusCode::kUnavailable);
  server_.reset();
  GiveServer(authority_.Issue("DNS:another.example"));
  StartServer();
  EXPECT_EQ(Connect(Believing(authority_)).ListMaps().status().code(), StatusCode::kUnavailable);
}

TEST_F(TlsTest, FilesThatDoNotFitAreRefusedAtTheStartByName) {
  const Issued good = authority_.Issue(kHere);
  GiveServer({good.cert, authority_.Issue(kHere).key});
  EXPECT_EQ(RefusedStart().reason(), "TLS_KEY_MISMATCH");
  GiveServer({good.cert, Authority::EncryptedKey()});
  EXPECT_EQ(RefusedStart().reason(), "TLS_FILE_INVALID");
  EXPECT_NE(RefusedStart().message().find("server.key"), std::string::npos);
  GiveServer({"no certificate", good.key});
  EXPECT_EQ(RefusedStart().reason(), "TLS_FILE_INVALID");
  EXPECT_NE(RefusedStart().message().find("server.crt"), std::string::npos);
  GiveServer(authority_.Issue(kHere, kExpired));
  EXPECT_EQ(RefusedStart().reason(), "TLS_CERTIFICATE_EXPIRED");
  GiveServer(authority_.Issue(kHere, kNotYet));
  EXPECT_EQ(RefusedStart().reason(), "TLS_CERTIFICATE_EXPIRED");
  GiveServer(good);
  options_.tls.client_ca = folder_.File("missing");
  EXPECT_EQ(RefusedStart().reason(), "TLS_FILE_UNREADABLE");
}

TEST_F(TlsTest, ARenewedCertificateIsServedWithoutARestart) {
  GiveServer(authority_.Issue(kHere));
  StartServer();
  const Client open = Connect(Believing(authority_));
  ASSERT_TRUE(open.ListMaps().ok());

  const Issued renewed = foreign_.Issue(kHere);
  folder_.Write("server.crt", renewed.cert);  // half done: the key is still the old one
  EXPECT_TRUE(Connect(Believing(authority_)).ListMaps().ok());
  folder_.Write("server.key", renewed.key);

  EXPECT_TRUE(Connect(Believing(foreign_)).ListMaps().ok());
  EXPECT_FALSE(Connect(Believing(authority_)).ListMaps().ok());
  EXPECT_TRUE(open.ListMaps().ok());  // what is open goes on
}

// No file changes any more, only the clock: the same holds for permissions that are corrected.
TEST_F(TlsTest, ARefusedCertificateIsServedOnceItIsGood) {
  GiveServer(authority_.Issue(kHere));
  StartServer();
  GiveServer(foreign_.Issue(kHere, {.begin_s = 3, .end_s = 3600}));
  EXPECT_TRUE(Connect(Believing(authority_)).ListMaps().ok());  // not valid yet
  EXPECT_TRUE(WaitFor([&] { return Connect(Believing(foreign_)).ListMaps().ok(); }));
}

TEST_F(TlsTest, ClientsWithoutAGoodCertificateGetNoConnection) {
  GiveServer(authority_.Issue(kHere));
  AskClientsOf(authority_);
  StartServer();
  const auto call = [this](const Issued& own) {
    return Connect(Believing(authority_, own)).ListMaps().status().code();
  };
  EXPECT_EQ(call(authority_.Issue("DNS:rover-1")), StatusCode::kOk);
  EXPECT_EQ(call({}), StatusCode::kUnavailable);
  EXPECT_EQ(call(foreign_.Issue("DNS:rover-1")), StatusCode::kUnavailable);
  EXPECT_EQ(call(authority_.Issue("DNS:rover-1", kExpired)), StatusCode::kUnavailable);
}

TEST_F(TlsTest, BeyondLoopbackNothingIsServedInTheClearUnlessSaid) {
  for (const char* everywhere : {"0.0.0.0:0", "[::]:0"}) {
    options_.listen = everywhere;
    EXPECT_EQ(RefusedStart().reason(), "INSECURE") << everywhere;
  }
  options_.insecure = true;
  StartServer();
  EXPECT_TRUE(Connect().ListMaps().ok());
}

TEST_F(TlsTest, BeyondLoopbackTlsAloneIsNotEnough) {
  options_.listen = "0.0.0.0:0";
  GiveServer(authority_.Issue(kHere));
  StartServer();
  ClientCredentials credentials = Believing(authority_);
  EXPECT_EQ(Connect(credentials).ListMaps().status().reason(), "TOKEN_MISSING");
  credentials.token = NewToken(Role::kViewer, "");  // while it is served
  EXPECT_TRUE(WaitFor([&] { return Connect(credentials).ListMaps().ok(); }));
}

TEST_F(TlsTest, BeyondLoopbackACertificateOfTheClientIsEnough) {
  options_.listen = "0.0.0.0:0";
  GiveServer(authority_.Issue(kHere));
  AskClientsOf(authority_);
  StartServer();
  EXPECT_TRUE(Connect(Believing(authority_, authority_.Issue("DNS:rover-1"))).ListMaps().ok());
}

}  // namespace
}  // namespace maploc::testing
