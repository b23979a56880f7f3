// A real server on a port of the system's choice, a real client, and the drawn street in a store on
// disk.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_store.h"
#include "server/app/server.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {

class ServiceTest : public ::testing::Test {
 protected:
  ServiceTest() : world_(TestRandom()), store_(OpenSqliteStore(folder_.File("store")).value()) {
    map_ = ImportWorld(world_, store_.get());
    options_.store = folder_.File("store");
    options_.listen = "127.0.0.1:0";
    options_.port_file = folder_.File("port");
    StartServer();
  }

  void StartServer() {
    Result<std::unique_ptr<Server>> server = Server::Start(options_);
    ASSERT_TRUE(server.ok()) << server.status().ToString();
    server_ = *std::move(server);
    client_ = std::make_unique<Client>(Address());
  }
  void RestartServer() {
    ASSERT_TRUE(server_->Shutdown().ok());
    server_.reset();
    StartServer();
  }
  std::string Address() const { return "127.0.0.1:" + std::to_string(server_->port()); }

  SessionId StartSession() {
    const Result<SessionId> session = client_->StartSession("street", "rover", {});
    EXPECT_TRUE(session.ok()) << session.status().ToString();
    return session.ok() ? *session : "";
  }

  // What a robot at `x` on the mapping path sees, looking ahead; segments are 12 m long.
  Query QueryAt(double x, const SessionId& session = "", int repetition = 0) const {
    Random random = TestRandom(1000 + repetition);
    Query query = world_.See(DrawnWorld::CameraFromMapAt(x, 0.2), QueryNoise(), random);
    query.session = session;
    return query;
  }
  static Eigen::Vector3d TruthAt(double x) { return {x, 0.3, 1.5}; }

  // Sessions' rows of a segment, as any process sees them.
  std::vector<SegmentSessionRow> Rows(SegmentId segment) const {
    return store_->ListRows(map_, segment).value();
  }
  std::int64_t CountedQueries() const {
    std::int64_t count = 0;
    const std::vector<SegmentSummary> segments = store_->ListSegments(map_).value();
    for (const SegmentSummary& segment : segments) {
      count += segment.statistics.queries;
    }
    return count;
  }

  const TemporaryFolder folder_;
  const DrawnWorld world_;
  const std::unique_ptr<MapStore> store_;  // a second process's view of the same file
  MapKey map_;
  ServerOptions options_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<Client> client_;
};

}  // namespace maploc::testing
