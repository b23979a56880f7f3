// A server with the drawn street, certificates made on the spot, and clients with credentials of
// every kind.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_store.h"
#include "server/access/token_file.h"
#include "server/app/server.h"
#include "tests/support/certificates.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {

class AccessTest : public ::testing::Test {
 protected:
  AccessTest() : world_(TestRandom()) {
    const auto store = OpenSqliteStore(folder_.File("store")).value();
    ImportWorld(world_, store.get());
    options_.store = folder_.File("store");
    options_.listen = "127.0.0.1:0";
  }

  // Into the files that the server's options name.
  void GiveServer(const Issued& issued) {
    folder_.Write("server.crt", issued.cert);
    folder_.Write("server.key", issued.key);
    options_.tls.cert = folder_.File("server.crt");
    options_.tls.key = folder_.File("server.key");
  }
  void AskClientsOf(const Authority& authority) {
    folder_.Write("clients.crt", authority.ca());
    options_.tls.client_ca = folder_.File("clients.crt");
  }
  void StartServer() {
    Result<std::unique_ptr<Server>> server = Server::Start(options_);
    ASSERT_TRUE(server.ok()) << server.status().ToString();
    server_ = *std::move(server);
  }
  Status RefusedStart() const { return Server::Start(options_).status(); }

  Client Connect(const ClientCredentials& credentials = {}) const {
    ClientOptions options;
    options.max_attempts = 1;
    options.credentials = credentials;
    return Client("127.0.0.1:" + std::to_string(server_->port()), options);
  }
  static ClientCredentials Believing(const Authority& authority, const Issued& own = {}) {
    return {authority.ca(), own.cert, own.key, ""};
  }

  // The token's text; of a robot where `robot` is not empty.
  std::string NewToken(Role role, const std::string& robot, std::vector<std::string> maps = {}) {
    const Result<Token> token = TokenFile(options_.store).Create({role, robot, std::move(maps)});
    EXPECT_TRUE(token.ok()) << token.status().ToString();
    return token.ok() ? TokenText(*token) : "";
  }
  Client ConnectAs(const std::string& token) const {
    ClientCredentials credentials;
    credentials.token = token;
    return Connect(credentials);
  }

  Query QueryIn(const SessionId& session) const {
    Random random = TestRandom(7);
    Query query = world_.See(DrawnWorld::CameraFromMapAt(5.0, 0.2), QueryNoise(), random);
    query.session = session;
    if (session.empty()) query.map = "street";
    return query;
  }

  const TemporaryFolder folder_;
  const DrawnWorld world_;
  const Authority authority_{"maploc test"};
  const Authority foreign_{"somebody else"};
  ServerOptions options_;
  std::unique_ptr<Server> server_;
};

}  // namespace maploc::testing
