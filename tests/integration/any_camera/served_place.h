// A made-up place on its whole way: written as COLMAP's files, imported into a store on disk,
// served by a real server and asked over the wire.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "client/api/client.h"
#include "mapstore/importers/colmap_importer.h"
#include "mapstore/store/sqlite_store.h"
#include "server/app/server.h"
#include "tests/integration/any_camera/place.h"
#include "tests/support/files.h"

namespace maploc::testing {

class ServedPlace {
 public:
  // Mapped through this lens, with half a pixel of noise.
  ServedPlace(const Place& place, const Camera& lens, Random random) {
    const Status written = WriteMapping(place, lens, 0.5, folder_.path(), random);
    EXPECT_TRUE(written.ok()) << written.ToString();
    Import();
    Serve();
  }

  Localization Ask(Query query) const {
    query.map = "place";
    const Result<Localization> answer = client_->Localize(query);
    EXPECT_TRUE(answer.ok()) << answer.status().ToString();
    return answer.ok() ? *answer : Localization();
  }

 private:
  void Import() {
    const std::unique_ptr<MapStore> store = OpenSqliteStore(folder_.File("store")).value();
    ColmapImportOptions options;
    options.map_name = "place";
    options.model_directory = folder_.File("model");
    options.database_path = folder_.File("database.db");
    options.line_file = folder_.File("lines.txt");
    options.descriptors = *DescriptorKindFromName("orb");
    options.gravity_in_source = Eigen::Vector3d(0, 0, -1);
    options.meters_per_unit = 1.0;
    const auto report = ImportColmap(options, [&]() -> Result<MapStore*> { return store.get(); });
    ASSERT_TRUE(report.ok()) << report.status().ToString();
  }
  void Serve() {
    ServerOptions options;
    options.store = folder_.File("store");
    options.listen = "127.0.0.1:0";
    Result<std::unique_ptr<Server>> server = Server::Start(options);
    ASSERT_TRUE(server.ok()) << server.status().ToString();
    server_ = *std::move(server);
    client_ = std::make_unique<Client>("127.0.0.1:" + std::to_string(server_->port()));
  }

  const TemporaryFolder folder_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<Client> client_;
};

}  // namespace maploc::testing
