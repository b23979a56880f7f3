// The versions of a map as an operator handles them.
#include "tests/integration/tools/maploc_map_fixture.h"

namespace maploc::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class MapVersions : public MaplocMap {
 protected:
  void SetUp() override {
    MaplocMap::SetUp();
    ASSERT_EQ(Map("export --store $STORE --map yard --to " + file_).exit_code, 0);
  }
  std::vector<std::string> States() {
    std::vector<std::string> states;
    const json versions = Json("versions --store $STORE --map yard");
    for (const json& version : versions) {
      states.push_back(version.at("state"));
    }
    return states;
  }
  int Enabled() { return Json("list --store $STORE")[0].at("version"); }

  const std::string file_ = folder_.File("yard.maploc");
};

TEST_F(MapVersions, ABadMapIsTakenBackWithOneCommand) {
  ASSERT_EQ(Map("import --store $STORE --from " + file_).exit_code, 0);
  ASSERT_EQ(Enabled(), 2);
  const Output back = Map("rollback --store $STORE --map yard");
  EXPECT_EQ(back.exit_code, 0) << back.error;
  EXPECT_THAT(back.out, HasSubstr("version 1 is enabled, version 2 no longer is"));
  EXPECT_EQ(Enabled(), 1);
  EXPECT_EQ(States(), (std::vector<std::string>{"ENABLED", "DISABLED"}));
  const json there = Json("rollback --store $STORE --map yard");
  EXPECT_EQ(there.at("version"), 2);
  EXPECT_EQ(there.at("version_before"), 1);
  EXPECT_EQ(there.at("changed"), true);
}

TEST_F(MapVersions, AStagedMapIsEnabledLater) {
  ASSERT_EQ(Map("import --store $STORE --stage --from " + file_).exit_code, 0);
  EXPECT_EQ(Enabled(), 1);
  ExpectFails("rollback --store $STORE --map yard", "no other version that was enabled before");
  ASSERT_EQ(Map("enable --store $STORE --map yard --version 2").exit_code, 0);
  EXPECT_EQ(Enabled(), 2);
  EXPECT_THAT(Map("enable --store $STORE --map yard --version 2").out,
              HasSubstr("enabled already"));
}

TEST_F(MapVersions, OneThatNobodyUsesIsDeleted) {
  ExpectFails("delete --store $STORE --map yard --version 1", "is the enabled one");
  ASSERT_EQ(Map("import --store $STORE --from " + file_).exit_code, 0);
  ExpectFails("delete --store $STORE --map yard --version 1", "has 1 open sessions");
  ASSERT_EQ(Map("import --store $STORE --from " + file_).exit_code, 0);
  for (const char* wrong : {"-1", "0", "1.5", "99999999999999999999"}) {
    const Output run = Map("delete --store $STORE --map yard --version " + std::string(wrong));
    EXPECT_EQ(run.exit_code, 2) << wrong;
    EXPECT_THAT(run.error, HasSubstr("must be a whole number, 1 or more, got")) << wrong;
  }
  EXPECT_EQ(Map("delete --store $STORE --map yard --version 2").exit_code, 0);
  EXPECT_EQ(States(), (std::vector<std::string>{"DISABLED", "ENABLED"}));
  EXPECT_EQ(Map("verify --store $STORE").exit_code, 0);
}

TEST_F(MapVersions, ASessionOnADeletedOneIsRevoked) {
  const auto idle =
      OpenSqliteStore(store_).value()->EndSession("open", SessionEnd::kIdle, 6000, {});
  ASSERT_TRUE(idle.ok());
  ASSERT_EQ(Map("import --store $STORE --from " + file_).exit_code, 0);
  ASSERT_EQ(Map("delete --store $STORE --map yard --version 1").exit_code, 0);
  const auto queries = [&] {
    return Json("segments --store $STORE --map yard")[1].at("queries").get<int>();
  };
  ASSERT_EQ(queries(), 21);
  EXPECT_EQ(Json("revoke --store $STORE --session s").at("segments"), json::array());
  EXPECT_EQ(queries(), 0);
}

TEST_F(MapVersions, OldOnesGoByThemselves) {
  const std::string import = "import --store $STORE --from " + file_;
  ASSERT_EQ(Map(import).exit_code, 0);
  ASSERT_EQ(Map(import).exit_code, 0);
  EXPECT_EQ(Json(import + " --keep-versions 1").at("deleted_versions"), json({2}))
      << "version 1 is in use, version 3 was enabled last";
  EXPECT_EQ(States(), (std::vector<std::string>{"DISABLED", "DISABLED", "ENABLED"}));
  const Output enable = Map("enable --store $STORE --map yard --version 4 --keep-versions 0");
  EXPECT_THAT(enable.out, HasSubstr("Version 3 is deleted."));
  EXPECT_EQ(Map(import + " --keep-versions -1").exit_code, 2);
  EXPECT_EQ(Map("verify --store $STORE").exit_code, 0);
}

TEST_F(MapVersions, ADeletedOneGivesItsSpaceBack) {
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(Map("import --store $STORE --from " + file_).exit_code, 0);
  }
  const json report = Json("delete --store $STORE --map yard --version 2");
  EXPECT_LT(report.at("store_bytes"), report.at("store_bytes_before"));
}

TEST_F(MapVersions, WhatIsNotThereIsNamed) {
  for (const std::string command :
       {"versions --map nowhere", "rollback --map nowhere", "enable --map nowhere --version 1",
        "delete --map nowhere --version 1"}) {
    ExpectFails(command + " --store $STORE", "map 'nowhere'");
  }
  EXPECT_EQ(Map("enable --store $STORE --map yard --version 0").exit_code, 2);
}

}  // namespace
}  // namespace maploc::testing
