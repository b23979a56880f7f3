#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

template <typename... T>
std::string Bytes(const T&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}

using U64 = std::uint64_t;
using U32 = std::uint32_t;

std::string Cameras(int model = 1) {
  return Bytes(U64{1}, U32{1}, model, U64{640}, U64{480}, 500.0, 510.0, 320.5, 240.5);
}
std::string Images(double qw = 1.0, U64 point_id = 7) {
  return Bytes(U64{1}, U32{3}, qw, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, U32{1}) + std::string("a.jpg") +
         '\0' + Bytes(U64{2}, 10.5, 20.5, point_id, 11.0, 21.0, ~U64{0});
}
std::string Points(double x = 0.25, U32 keypoint = 0, U64 track_length = 1) {
  const std::string color = "rgb";
  return Bytes(U64{1}, U64{7}, x, -1.0, 8.0) + color + Bytes(0.5, track_length, U32{3}, keypoint);
}

class ColmapBinaryTest : public ::testing::Test {
 protected:
  Result<ColmapModel> Read(const std::string& cameras, const std::string& images,
                           const std::string& points) {
    folder_.Write("cameras.bin", cameras);
    folder_.Write("images.bin", images);
    folder_.Write("points3D.bin", points);
    return ReadColmapModel(folder_.path());
  }
  std::string Error(const std::string& file, const std::string& cameras, const std::string& images,
                    const std::string& points) {
    const Result<ColmapModel> model = Read(cameras, images, points);
    if (model.ok()) return "read";
    EXPECT_THAT(model.status().message(), HasSubstr(folder_.File(file) + ": byte "));
    return model.status().message();
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ColmapBinaryTest, ReadsWhatColmapWrites) {
  const Result<ColmapModel> model = Read(Cameras(), Images(), Points());
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->cameras.at(1).principal_point_px(), Eigen::Vector2d(320, 240));
  const ColmapImage& image = model->images.at(3);
  EXPECT_EQ(image.name, "a.jpg");
  EXPECT_EQ(image.camera_from_source.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(image.keypoints_px[0], Eigen::Vector2d(10, 20));
  EXPECT_THAT(image.point_ids, ::testing::ElementsAre(7, -1));
  EXPECT_EQ(model->points.at(7).position_in_source, Eigen::Vector3d(0.25, -1, 8));
  EXPECT_EQ(model->points.at(7).track[0].image_id, 3);
}

TEST_F(ColmapBinaryTest, PrefersBinaryWhereBothStand) {
  folder_.Write("cameras.txt", "broken");
  folder_.Write("images.txt", "broken");
  folder_.Write("points3D.txt", "broken");
  EXPECT_TRUE(Read(Cameras(), Images(), Points()).ok());
}

TEST_F(ColmapBinaryTest, EveryTruncationIsRefusedWithItsByte) {
  for (std::size_t length = 0; length < Points().size(); ++length) {
    EXPECT_NE(Error("points3D.bin", Cameras(), Images(), Points().substr(0, length)), "read");
  }
  for (std::size_t length = 0; length < Images().size(); ++length) {
    EXPECT_NE(Error("images.bin", Cameras(), Images().substr(0, length), Points()), "read");
  }
  for (std::size_t length = 0; length < Cameras().size(); ++length) {
    EXPECT_NE(Error("cameras.bin", Cameras().substr(0, length), Images(), Points()), "read");
  }
  EXPECT_THAT(Error("points3D.bin", Cameras(), Images(), Points() + "x"),
              HasSubstr("1 bytes follow"));
}

TEST_F(ColmapBinaryTest, ACountBeyondTheFileIsRefusedBeforeMemoryIsAskedFor) {
  EXPECT_THAT(Error("points3D.bin", Cameras(), Images(), Points(0.25, 0, U64{1} << 60)),
              HasSubstr("track length: is 1152921504606846976"));
  EXPECT_THAT(Error("cameras.bin", Bytes(~U64{0}), Images(), Points()),
              HasSubstr("number of cameras"));
}

TEST_F(ColmapBinaryTest, RefusesWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Error("cameras.bin", Cameras(77), Images(), Points()), HasSubstr("'number 77'"));
  EXPECT_THAT(Error("images.bin", Cameras(), Images(0.0), Points()), HasSubstr("quaternion"));
  EXPECT_THAT(Error("images.bin", Cameras(), Images(nan), Points()), HasSubstr("quaternion"));
  EXPECT_THAT(Error("images.bin", Cameras(), Images(1.0, 8), Points()), HasSubstr("point 8"));
  EXPECT_THAT(Error("points3D.bin", Cameras(), Images(), Points(nan)), HasSubstr("position"));
  EXPECT_THAT(Error("points3D.bin", Cameras(), Images(), Points(0, 5)), HasSubstr("keypoint 5"));
}

TEST_F(ColmapBinaryTest, NoDamageCrashesIt) {
  Random random = testing::TestRandom();
  for (int i = 0; i < 400; ++i) {
    std::string files[3] = {Cameras(), Images(), Points()};
    std::string& file = files[random.Below(3)];
    for (std::uint32_t flips = random.Below(3) + 1; flips > 0; --flips) {
      file[random.Below(static_cast<std::uint32_t>(file.size()))] =
          static_cast<char>(random.Below(256));
    }
    const Result<ColmapModel> model = Read(files[0], files[1], files[2]);
    if (!model.ok()) continue;
    for (const auto& [id, point] : model->points) EXPECT_TRUE(point.position_in_source.allFinite());
  }
}

}  // namespace
}  // namespace maploc
