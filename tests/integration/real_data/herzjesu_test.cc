// A church front: SIFT, photos, LiDAR reference. The bounds are issue 2's.
#include "tests/integration/real_data/real_data_fixture.h"

namespace maploc::testing {
namespace {

class HerzjesuTest : public RealDataTest {
 protected:
  void SetUp() override { Require("herzjesu"); }

  json Import(bool with_database) const {
    std::vector<std::string> arguments = {"import-colmap", "--store",   Store(),     "--map",
                                          "church",        "--model",   Data("map"), "--images",
                                          Data("images"),  "--gravity", "0,0,1"};
    if (with_database) {
      arguments.insert(arguments.end(), {"--database", Data("database.db")});
    }
    return Run("maploc-map", arguments);
  }
  json ReplayQuery(bool with_database) const {
    std::vector<std::string> arguments = {
        "--images", Data("images"), "--gravity-noise-deg", "0.5", "--prior", "none", "--seed", "1"};
    if (with_database) {
      arguments.insert(arguments.end(), {"--database", Data("database.db")});
    }
    return Replay("church", "query", arguments);
  }
};

TEST_F(HerzjesuTest, EveryPhotoIsLocalizedToACentimetre) {
  ASSERT_TRUE(Import(true).is_object());
  const json maps = Run("maploc-map", {"list", "--store", Store()});
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_GE(maps[0]["lines"], 200);
  ASSERT_NO_FATAL_FAILURE(Serve(Store()));

  const json report = ReplayQuery(true);

  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["queries"], 8);
  EXPECT_EQ(report["localized"], 8);
  EXPECT_EQ(report["wrong"], 0);
  const std::vector<json> queries = Queries(report);
  ASSERT_EQ(queries.size(), 8u);
  const std::vector<double> translation = Errors(queries, "translation_error_m");
  const std::vector<double> rotation = Errors(queries, "rotation_error_deg");
  EXPECT_LE(Median(translation), 0.01);
  EXPECT_LE(Median(rotation), 0.05);
  EXPECT_LE(translation.back(), 0.05);
  EXPECT_LE(rotation.back(), 0.2);
  const auto has_lines = [](const json& query) { return query["line_inliers"] > 0; };
  EXPECT_GE(std::count_if(queries.begin(), queries.end(), has_lines), 6);
}

TEST_F(HerzjesuTest, OwnFeaturesAtBothEndsWillDo) {
  ASSERT_TRUE(Import(false).is_object());
  ASSERT_NO_FATAL_FAILURE(Serve(Store()));
  const json report = ReplayQuery(false);
  ASSERT_TRUE(report.is_object());
  const std::vector<json> queries = Queries(report);
  const auto good = [](const json& query) { return Within(query, 0.25, 2.0); };
  EXPECT_GE(std::count_if(queries.begin(), queries.end(), good), 7);
}

}  // namespace
}  // namespace maploc::testing
