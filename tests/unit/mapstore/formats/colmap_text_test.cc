#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

constexpr const char* kCameras =
    "# Camera list\n"
    "1 PINHOLE 640 480 500 510 320.5 240.5\n"
    "2 SIMPLE_RADIAL 640 480 500 320 240 -0.1\n";
constexpr const char* kImages =
    "# Image list with two lines of data per image:\n"
    "3 2 0 0 0 1 2 3 1 map/first one.jpg\n"
    "10.5 20.5 7 11 21 -1\n"
    "4 0.5 0.5 0.5 0.5 0 0 0 2 map/b.jpg\n"
    "\n"
    "5 1 0 0 0 0 0 0 1 map/c.jpg\n"
    "1.5 2.5 7\n";
constexpr const char* kPoints =
    "# 3D point list\n"
    "7 0.25 -1 8e0 255 0 0 0.5 3 0 5 0\n";

class ColmapTextTest : public ::testing::Test {
 protected:
  Result<ColmapModel> Read(const std::string& cameras, const std::string& images,
                           const std::string& points) {
    folder_.Write("cameras.txt", cameras);
    folder_.Write("images.txt", images);
    folder_.Write("points3D.txt", points);
    return ReadColmapModel(folder_.path());
  }
  // The error of reading the files; it must be about `where`, a file's name with its line.
  std::string Error(const std::string& where, const std::string& cameras, const std::string& images,
                    const std::string& points) {
    const Result<ColmapModel> model = Read(cameras, images, points);
    if (model.ok()) return "read";
    EXPECT_EQ(model.status().code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(model.status().message(), HasSubstr(folder_.File(where) + ": "));
    return model.status().message();
  }
  std::string CameraError(const std::string& line) {
    return Error("cameras.txt:1", line + "\n", "", "");
  }
  std::string ImageError(const std::string& header, const std::string& keypoints, int line = 2) {
    return Error("images.txt:" + std::to_string(line), kCameras, header + "\n" + keypoints + "\n",
                 kPoints);
  }
  std::string PointError(const std::string& line) {
    return Error("points3D.txt:1", kCameras, kImages, line + "\n");
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ColmapTextTest, ReadsCamerasImagesAndPointsInOurPixels) {
  const Result<ColmapModel> model = Read(kCameras, kImages, kPoints);
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  ASSERT_EQ(model->cameras.size(), 2u);
  EXPECT_EQ(model->cameras.at(1).principal_point_px(), Eigen::Vector2d(320, 240));
  EXPECT_EQ(model->cameras.at(2).principal_point_px(), Eigen::Vector2d(319.5, 239.5));
  EXPECT_EQ(model->cameras.at(2).params()[3], -0.1);
  ASSERT_EQ(model->images.size(), 3u);
  const ColmapImage& image = model->images.at(3);
  EXPECT_EQ(image.name, "map/first one.jpg");
  EXPECT_EQ(image.camera_from_source.rotation.w(), 1.0) << "the quaternion is normalized";
  EXPECT_EQ(image.camera_from_source.translation, Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(image.keypoints_px.size(), 2u);
  EXPECT_EQ(image.keypoints_px[0], Eigen::Vector2d(10, 20));
  EXPECT_THAT(image.point_ids, ::testing::ElementsAre(7, -1));
  EXPECT_TRUE(model->images.at(4).keypoints_px.empty());
  EXPECT_EQ(model->images.at(5).point_ids.size(), 1u) << "a blank line belongs to its own image";
  ASSERT_EQ(model->points.size(), 1u);
  const ColmapPoint& point = model->points.at(7);
  EXPECT_EQ(point.position_in_source, Eigen::Vector3d(0.25, -1, 8));
  EXPECT_EQ(point.error_px, 0.5);
  ASSERT_EQ(point.track.size(), 2u);
  EXPECT_EQ(point.track[1].image_id, 5);
}

TEST_F(ColmapTextTest, AModelOfPosesAloneIsFine) {
  const Result<ColmapModel> model =
      Read(kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n\n2 1 0 0 0 0 0 0 1 b.jpg\n", "# nothing\n");
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->images.size(), 2u);
}

TEST_F(ColmapTextTest, RefusesABrokenCamera) {
  EXPECT_THAT(CameraError("x PINHOLE 640 480 1 1 1 1"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(CameraError("1 PINHOLE 640 480 1 1 1"), HasSubstr("takes 4 parameters, got 3"));
  EXPECT_THAT(CameraError("1 PINHOLE 640 480 0 1 1 1"), HasSubstr("focal length"));
  EXPECT_THAT(CameraError("1 PINHOLE 640 480 nan 1 1 1"), HasSubstr("is not finite"));
  EXPECT_THAT(CameraError("1 PINHOLE 0 480 1 1 1 1"), HasSubstr("camera size"));
  EXPECT_THAT(CameraError("1 PINHOLE 99999999999 480 1 1 1 1"), HasSubstr("camera size"));
  EXPECT_THAT(CameraError("-1 PINHOLE 640 480 1 1 1 1"), HasSubstr("negative"));
  EXPECT_THAT(Error("cameras.txt:2", "1 PINHOLE 9 9 1 1 1 1\n1 PINHOLE 9 9 1 1 1 1\n", "", ""),
              HasSubstr("stands twice"));
}

TEST_F(ColmapTextTest, RefusesABrokenImage) {
  EXPECT_THAT(ImageError("1 1 0 0", "", 1), HasSubstr("rotation: is missing"));
  EXPECT_THAT(ImageError("1 0 0 0 0 0 0 0 1 a.jpg", "", 1), HasSubstr("quaternion"));
  EXPECT_THAT(ImageError("1 nan 0 0 0 0 0 0 1 a.jpg", "", 1), HasSubstr("is not finite"));
  EXPECT_THAT(ImageError("1 1 0 0 0 0 1e300 0 1 a.jpg", "", 1), HasSubstr("translation"));
  EXPECT_THAT(ImageError("1 1 0 0 0 0 0 0 9 a.jpg", ""), HasSubstr("9 is not among the cameras"));
  EXPECT_THAT(ImageError("1 1 0 0 0 0 0 0 1", ""), HasSubstr("image name: is missing"));
  EXPECT_THAT(ImageError("1 1 0 0 0 0 0 0 1 a.jpg", "1 2 7 3"),
              HasSubstr("keypoint y: is missing"));
  EXPECT_THAT(ImageError("1 1 0 0 0 0 0 0 1 a.jpg", "1 inf 7"), HasSubstr("is not finite"));
  EXPECT_THAT(ImageError("1 1 0 0 0 0 0 0 1 a.jpg", "1 2 -7"), HasSubstr("point id is negative"));
}

TEST_F(ColmapTextTest, RefusesAnImageWhosePointDoesNotExist) {
  EXPECT_THAT(Error("images.txt:2", kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n1 2 8\n", ""),
              HasSubstr("point 8 is not among the points"));
}

TEST_F(ColmapTextTest, RefusesABrokenPoint) {
  EXPECT_THAT(PointError("7 0 0"), HasSubstr("position: is missing"));
  EXPECT_THAT(PointError("7 0 0 nan 1 1 1 0.5"), HasSubstr("is not finite"));
  EXPECT_THAT(PointError("7 0 0 1 1 1 1 0.5 3"), HasSubstr("track's keypoint: is missing"));
  EXPECT_THAT(PointError("7 0 0 1 1 1 1 0.5 99 0"), HasSubstr("image 99, which does not exist"));
  EXPECT_THAT(PointError("7 0 0 1 1 1 1 0.5 3 2"), HasSubstr("keypoint 2 of image 3, which has 2"));
  EXPECT_THAT(PointError("7 0 0 1 1 1 1 0.5 3 -1"), HasSubstr("keypoint -1"));
  EXPECT_THAT(PointError("-7 0 0 1 1 1 1 0.5"), HasSubstr("negative"));
}

TEST_F(ColmapTextTest, NamesWhatIsMissing) {
  EXPECT_EQ(ReadColmapModel(folder_.path() + "/absent").status().code(), StatusCode::kNotFound);
  folder_.Write("cameras.txt", kCameras);
  EXPECT_THAT(ReadColmapModel(folder_.path()).status().message(), HasSubstr("not a COLMAP model"));
}

TEST_F(ColmapTextTest, NoTruncationAndNoDamageCrashesIt) {
  const std::string images(kImages);
  for (std::size_t length = 0; length < images.size(); ++length) {
    (void)Read(kCameras, images.substr(0, length), kPoints);
    std::string damaged = images;
    damaged[length] = static_cast<char>(damaged[length] ^ 0x15);
    (void)Read(kCameras, damaged, kPoints);
  }
}

TEST(ColmapCameraLineTest, ReadsOneLineAndNamesItsPlace) {
  const Result<Camera> camera = ParseColmapCameraLine("1 PINHOLE 640 480 500 500 320 240", "cam");
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(camera->principal_point_px(), Eigen::Vector2d(319.5, 239.5));
  EXPECT_THAT(ParseColmapCameraLine("1 PINHOLE 640", "cam.txt:7").status().message(),
              HasSubstr("cam.txt:7: "));
}

}  // namespace
}  // namespace maploc
