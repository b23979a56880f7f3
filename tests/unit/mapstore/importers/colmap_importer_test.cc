#include "mapstore/importers/colmap_importer.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap_writer.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/importers/point_geometry.h"
#include "mapstore/store/in_memory_store.h"
#include "tests/support/files.h"
#include "tests/support/pose_priors.h"
#include "tests/support/seed.h"
#include "tests/unit/mapstore/importers/drawn_scene.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

// A model of ten photos and sixty points, with its database, in a frame that leans and has its own
// unit.
class ColmapImporterTest : public ::testing::Test {
 protected:
  ColmapImporterTest() : store_(NewInMemoryStore()) {
    Random random = testing::TestRandom();
    const testing::DrawnScene scene = testing::MakeScene(random, 10, 0);
    for (const KeyFrame& frame : scene.frames) {
      model_.cameras.emplace(1, frame.camera);
      ColmapImage image{
          frame.image_id, 1, frame.name, MovePose(source_from_map_, frame.camera_from_map), {}, {}};
      model_.images.emplace(image.id, image);
    }
    for (int i = 0; i < 60; ++i)
      AddPoint(scene, i, {0.15 * i - 1, random.Uniform(-1, 1), random.Uniform(0, 3)});
    options_.map_name = "yard";
    options_.model_directory = folder_.File("model");
    options_.database_path = folder_.File("database.db");
    options_.gravity_in_source = source_from_map_.rotation * Eigen::Vector3d(0, 0, -3);
    options_.meters_per_unit = 0.5;
    WriteFiles();
  }

  void AddPoint(const testing::DrawnScene& scene, int id, const Eigen::Vector3d& in_map) {
    ColmapPoint point{id, source_from_map_ * in_map, 0.1, {}};
    for (const KeyFrame& frame : scene.frames) {
      const auto pixel = frame.camera.Project(frame.camera_from_map * in_map);
      if (!pixel || pixel->x() < 0 || pixel->x() > 999 || pixel->y() < 0 || pixel->y() > 799)
        continue;
      ColmapImage& image = model_.images.at(frame.image_id);
      point.track.push_back({image.id, static_cast<std::int32_t>(image.keypoints_px.size())});
      image.keypoints_px.push_back(*pixel);
      image.point_ids.push_back(id);
      PointFeatures& features = features_[image.name];
      features.keypoints_px.push_back(pixel->cast<float>());
      features.descriptors.kind = *DescriptorKindFromName("binary4");
      for (const int byte : {id, id, static_cast<int>(image.id), 7}) {
        features.descriptors.bytes.push_back(static_cast<std::uint8_t>(byte));
      }
    }
    model_.points.emplace(id, point);
  }
  void WriteFiles() {
    ASSERT_TRUE(WriteColmapModel(options_.model_directory, model_).ok());
    ASSERT_TRUE(WriteColmapDatabase(options_.database_path, model_, features_).ok());
  }
  Result<ColmapImportReport> Import() {
    return ImportColmap(options_, [this]() -> Result<MapStore*> { return store_.get(); });
  }
  // The error of an import that must leave nothing behind.
  std::string Error() {
    const Result<ColmapImportReport> report = Import();
    EXPECT_TRUE(store_->ListMaps()->empty());
    return report.ok() ? "imported" : report.status().message();
  }

  // Leans, is turned, and has units of half a metre.
  const Similarity3 source_from_map_{
      2.0,
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized())),
      {10, -20, 5}};
  testing::TemporaryFolder folder_;
  std::unique_ptr<MapStore> store_;
  ColmapModel model_;
  std::map<std::string, PointFeatures> features_;
  ColmapImportOptions options_;
};

TEST_F(ColmapImporterTest, PutsGravityOnTheMapsAxisAndTheUnitOnMetres) {
  const Result<ColmapImportReport> report = Import();
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  EXPECT_TRUE(report->info.metric);
  EXPECT_EQ(report->points, 60);
  const Similarity3& map_from_source = report->info.map_from_source;
  const Eigen::Vector3d down = source_from_map_.rotation * kGravityInMap;
  EXPECT_LT((map_from_source.rotation * down - kGravityInMap).norm(), 1e-12);
  const auto segment = *store_->LoadSegment(report->info.key, 0);
  ASSERT_GT(segment->points.size(), 10);
  for (int i = 1; i < segment->points.size(); ++i) {  // distances are the scene's own, in metres
    const auto a = static_cast<std::size_t>(i - 1);
    const auto b = static_cast<std::size_t>(i);
    const auto source = [&](std::size_t k) {
      return model_.points.at(segment->points.ids[k]).position_in_source;
    };
    EXPECT_NEAR((segment->points.positions_in_map[a] - segment->points.positions_in_map[b]).norm(),
                (source(a) - source(b)).norm() / 2, 1e-9);
  }
  EXPECT_LE(segment->points.descriptors.size(), 8 * segment->points.size());
}

TEST_F(ColmapImporterTest, WithoutScaleTheUnitIsUnknown) {
  options_.meters_per_unit.reset();
  EXPECT_FALSE(Import()->info.metric);
}

TEST_F(ColmapImporterTest, PosesAloneAreRefusedAndMeasurementsTaken) {
  const Eigen::Vector3d down = *options_.gravity_in_source;
  options_.gravity_in_source.reset();
  EXPECT_THAT(Error(), HasSubstr("--gravity"));
  std::map<std::string, Eigen::Vector3d> gravity;
  for (const auto& [id, image] : model_.images) {
    gravity[image.name] = image.camera_from_source.rotation * down;
  }
  testing::AddPosePriors(options_.database_path, model_, gravity);
  const Result<ColmapImportReport> report = Import();
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  EXPECT_EQ(report->gravity.source, GravityOrigin::kMeasured);
  EXPECT_LT(AngleBetween(report->gravity.down_in_source, down.normalized()), 1e-6);
  options_.gravity_in_source = -down;
  EXPECT_THAT(Import().status().message(), HasSubstr("pose_priors"));
  options_.force = true;
  EXPECT_TRUE(Import().ok());
}

TEST_F(ColmapImporterTest, SegmentsShareTheLandmarksOfTheirBorder) {
  options_.segment_length = 2.0;
  const Result<ColmapImportReport> report = Import();
  ASSERT_TRUE(report.ok());
  ASSERT_GE(report->segments, 3);
  for (SegmentId id = 1; id < report->segments; ++id) {
    const auto before = *store_->LoadSegment(report->info.key, id - 1);
    const auto after = *store_->LoadSegment(report->info.key, id);
    std::vector<LandmarkId> shared;
    std::set_intersection(before->points.ids.begin(), before->points.ids.end(),
                          after->points.ids.begin(), after->points.ids.end(),
                          std::back_inserter(shared));
    EXPECT_GT(shared.size(), 5u);
  }
}

TEST_F(ColmapImporterTest, WhatMakesNoSenseIsRefusedAndLeavesNothing) {
  options_.gravity_in_source = Eigen::Vector3d::Zero();
  EXPECT_THAT(Error(), HasSubstr("gravity"));
  options_.gravity_in_source = Eigen::Vector3d(0, 0, 1);
  options_.meters_per_unit = 0.0;
  EXPECT_THAT(Error(), HasSubstr("scale"));
  options_.meters_per_unit.reset();
  options_.segment_length = -1.0;
  EXPECT_THAT(Error(), HasSubstr("segment-length"));
  options_.segment_length.reset();
  options_.triangulate = true;
  EXPECT_THAT(Error(), HasSubstr("--images"));
  options_.triangulate = false;
  options_.line_file = folder_.File("absent.txt");
  EXPECT_THAT(Error(), HasSubstr("absent.txt"));
  options_.line_file.clear();
  options_.database_path.clear();
  EXPECT_THAT(Error(), HasSubstr("--database"));
  options_.images_directory = folder_.path();
  EXPECT_THAT(Error(), HasSubstr("img0.jpg"));
}

// Whole photos of one shade, but for those that are cut: the start of a JPEG.
TEST_F(ColmapImporterTest, TruncatedPhotosAreLeftOutAndNamed) {
  options_.images_directory = folder_.path();
  for (const auto& [id, image] : model_.images) {
    folder_.Write(image.name, "P5 1000 800 255\n" + std::string(800000, 'a'));
  }
  ASSERT_TRUE(Import().ok());
  EXPECT_TRUE(Import()->notices.empty());
  for (const char* name : {"img1.jpg", "img3.jpg", "img5.jpg", "img7.jpg"}) {
    folder_.Write(name, "\xFF\xD8\xFF\xE0");
  }
  const Result<ColmapImportReport> report = Import();
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  EXPECT_EQ(report->points, 60) << "a photo's database entries and pose are whole";
  ASSERT_EQ(report->notices.size(), 1u);
  EXPECT_THAT(report->notices[0], HasSubstr("4 of 10 photos are truncated and were left out: "
                                            "img1.jpg, img3.jpg, img5.jpg and 1 more;"));
  options_.gravity_in_source.reset();
  const std::string error = Import().status().message();
  EXPECT_THAT(error, HasSubstr("4 of 10 photos are truncated")) << "a failure may come of it";
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

TEST_F(ColmapImporterTest, TellsOnceThatPhotosAreLarge) {
  const Camera& small = model_.cameras.at(1);
  std::vector<double> params = small.params();
  for (double& value : params) value *= 3;
  model_.cameras.at(1) = *Camera::Create(small.model(), 3000, 2400, params);
  WriteFiles();
  EXPECT_TRUE(Import()->notices.empty()) << "no photo is looked at";
  options_.images_directory = folder_.path();
  for (const auto& [id, image] : model_.images) {
    folder_.Write(image.name, "P5 3000 2400 255\n" + std::string(7200000, 'a'));
  }
  const Result<ColmapImportReport> report = Import();
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  ASSERT_EQ(report->notices.size(), 1u);
  EXPECT_THAT(report->notices[0], HasSubstr("10 of 10 photos are large"));
  EXPECT_THAT(report->notices[0], HasSubstr("(3000x2400 at 2190x1752)"));
}

TEST_F(ColmapImporterTest, AMapNameThatNoStoreTakesIsRefusedBeforeTheWork) {
  options_.model_directory = "/absent";  // would be the error if the work began
  options_.map_name = std::string(129, 'a');
  EXPECT_THAT(Error(), HasSubstr("map name: is 129 bytes long, at most 128 are allowed"));
  options_.map_name =
      "Stra\xDF"
      "e";
  EXPECT_THAT(Error(), HasSubstr("map name: is not UTF-8 at byte 4"));
  options_.map_name = "";
  EXPECT_THAT(Error(), HasSubstr("map name: is empty"));
}

// Names of files are as long and in what encoding their owner's disk has them.
TEST_F(ColmapImporterTest, LongAndForeignImageNamesAreTaken) {
  int count = 0;
  for (const std::string& name : {std::string(300, 'a'), std::string("Stra\xDF"
                                                                     "e (1).jpg")}) {
    ColmapImage& image = model_.images.at(++count);
    features_[name] = features_.at(image.name);
    features_.erase(image.name);
    image.name = name;
  }
  WriteFiles();
  const Result<ColmapImportReport> report = Import();
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  EXPECT_EQ(report->points, 60);
}

TEST_F(ColmapImporterTest, ADatabaseOfAnotherModelIsRefused) {
  features_["img3.jpg"].keypoints_px[0].x() += 2.0f;
  WriteFiles();
  EXPECT_THAT(Error(), HasSubstr("keypoint 0 of image 'img3.jpg' is not where the model has it"));
  features_.erase("img3.jpg");
  WriteFiles();
  EXPECT_THAT(Error(), HasSubstr("'img3.jpg' has 0 keypoints"));
}

TEST_F(ColmapImporterTest, ACutDatabaseIsRefused) {
  const auto size = std::filesystem::file_size(options_.database_path);
  std::filesystem::resize_file(options_.database_path, size / 2);
  EXPECT_THAT(Error(), HasSubstr("is truncated"));
}

TEST(TriangulatePointTest, MeetsInTheTruePointAndNotBehindACamera) {
  const Eigen::Vector3d truth(0.4, 0.2, 1.1);
  std::vector<PointObservation> views;
  for (int i = 0; i < 4; ++i) {
    const KeyFrame frame = testing::MakeFrame(i, {0.5 * i, -8, 1.5});
    const Eigen::Vector3d p = frame.camera_from_map * truth;
    views.push_back({frame.camera_from_map, p.head<2>() / p.z(), 800});
  }
  EXPECT_LT((*TriangulatePoint(views) - truth).norm(), 1e-9);
  for (PointObservation& view : views) view.normalized.x() *= -1;  // the rays part
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].normalized.x() = 0.1 * static_cast<double>(i);
  EXPECT_FALSE(TriangulatePoint(views).has_value());
}

}  // namespace
}  // namespace maploc
