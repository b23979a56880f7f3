// grpc.health.v1 of each map by its name.
#include "server/app/health_board.h"
#include "tests/integration/service/service_fixture.h"
#include "tests/support/byte_stream.h"

namespace maploc::testing {
namespace {

class MapHealthTest : public ServiceTest {
 protected:
  // Whoever watches before the server knows the map hears UNKNOWN first.
  std::unique_ptr<ByteStream> WatchMap(const std::string& map) const {
    const std::string name = "map/" + map;
    return std::make_unique<ByteStream>(
        Address(), "/grpc.health.v1.Health/Watch",
        "\x0a" + std::string(1, static_cast<char>(name.size())) + name);
  }
  const std::string unknown_{"\x08\x03", 2};
};

TEST_F(MapHealthTest, AMapIsServedAsSoonAsItIsInTheStore) {
  const auto street = WatchMap("street");
  std::string status = street->Read();
  if (status == unknown_) status = street->Read();
  EXPECT_EQ(status, kServing);

  const auto garden = WatchMap("garden");
  EXPECT_EQ(garden->Read(), unknown_);
  MapInfo info = world_.info();
  info.key.name = "garden";
  auto writer = store_->BeginImport(info).value();
  ASSERT_TRUE(writer->AddSegment(*world_.segments()[0]).ok());
  ASSERT_TRUE(writer->Commit().ok());
  EXPECT_EQ(garden->Read(), kServing);

  std::filesystem::remove(options_.store);  // nothing can be served any more
  EXPECT_EQ(street->Read(), kNotServing);
  EXPECT_EQ(garden->Read(), kNotServing);
}

// gRPC's service without gRPC.
class FakeHealthService final : public grpc::HealthCheckServiceInterface {
 public:
  void SetServingStatus(const std::string& name, bool serving) override { told[name] = serving; }
  void SetServingStatus(bool serving) override {
    for (auto& [name, told_serving] : told) told_serving = serving;
  }
  void Shutdown() override {}
  std::map<std::string, bool> told;
};

TEST(HealthBoardTest, AMapIsAsGoodAsTheServerAtMost) {
  FakeHealthService service;
  HealthBoard board;
  board.SetMaps({{"good", true}, {"damaged", false}, {"deleted", true}});
  board.Open(&service);
  EXPECT_TRUE(service.told["map/good"]);
  EXPECT_FALSE(service.told["map/damaged"]);
  EXPECT_TRUE(service.told["map/deleted"]);
  board.SetMaps({{"good", true}, {"damaged", false}});
  EXPECT_FALSE(service.told["map/deleted"]);
  board.SetHealthy(false);
  EXPECT_FALSE(service.told[""]);
  EXPECT_FALSE(service.told["map/good"]);
  board.SetHealthy(true);
  EXPECT_TRUE(service.told["map/good"]);
  EXPECT_FALSE(service.told["map/damaged"]);
  board.Close();
  board.SetHealthy(true);
  EXPECT_FALSE(service.told["map/good"]);
}

TEST(HealthBoardTest, TheNumberOfNamesIsBounded) {
  FakeHealthService service;
  HealthBoard board;
  board.Open(&service);
  for (int round = 0; round < 3; ++round) {
    std::map<std::string, bool> maps;
    for (int i = 0; i < 700; ++i) maps[std::to_string(round) + "/" + std::to_string(i)] = true;
    board.SetMaps(maps);
  }
  EXPECT_LE(service.told.size(), kMaxMapsWithHealth + 3);
}

}  // namespace
}  // namespace maploc::testing
