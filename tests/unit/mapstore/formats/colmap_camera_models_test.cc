// Every camera model of COLMAP 4, in both forms of a model: used by an image or by none.
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Model {
  int number;
  std::string name;
  int param_count;
  bool is_computed;
};

const Model kModels[] = {
    {0, "SIMPLE_PINHOLE", 3, true},
    {1, "PINHOLE", 4, true},
    {2, "SIMPLE_RADIAL", 4, true},
    {3, "RADIAL", 5, true},
    {4, "OPENCV", 8, true},
    {5, "OPENCV_FISHEYE", 8, true},
    {6, "FULL_OPENCV", 12, false},
    {7, "FOV", 5, false},
    {8, "SIMPLE_RADIAL_FISHEYE", 4, true},
    {9, "RADIAL_FISHEYE", 5, true},
    {10, "THIN_PRISM_FISHEYE", 12, false},
    {11, "RAD_TAN_THIN_PRISM_FISHEYE", 16, false},
    {12, "SIMPLE_DIVISION", 4, false},
    {13, "DIVISION", 5, false},
    {14, "SIMPLE_FISHEYE", 3, true},
    {15, "FISHEYE", 4, true},
    {16, "EUCM", 6, false},
    {17, "EQUIRECTANGULAR", 2, false},
};

class CameraModels : public ::testing::TestWithParam<Model> {
 protected:
  // Focal lengths and principal point of 100, coefficients of 0.001.
  std::vector<double> Params(int count) const {
    std::vector<double> params(static_cast<std::size_t>(count), 0.001);
    for (int i = 0; i < std::min(count, 4); ++i) params[static_cast<std::size_t>(i)] = 100;
    if (count > 3 && GetParam().name.starts_with("SIMPLE")) params[3] = 0.001;
    return params;
  }
  // Camera 1 is of the model, camera 2 a pinhole; one image has the camera `used`.
  Result<ColmapModel> ReadText(int used) {
    std::string camera = "1 " + GetParam().name + " 200 100";
    for (const double param : Params(GetParam().param_count)) camera += " " + std::to_string(param);
    folder_.Write("cameras.txt", camera + "\n2 PINHOLE 200 100 100 100 100 50\n");
    folder_.Write("images.txt", "1 1 0 0 0 0 0 0 " + std::to_string(used) + " a.jpg\n\n");
    folder_.Write("points3D.txt", "");
    return ReadColmapModel(folder_.path());
  }
  Result<ColmapModel> ReadBinary(int used) {
    std::string cameras = Bytes(std::uint64_t{2}) +
                          Camera(1, GetParam().number, Params(GetParam().param_count)) +
                          Camera(2, 1, {100, 100, 100, 50});
    folder_.Write("cameras.bin", cameras);
    std::string image = Bytes(std::uint64_t{1}) + Bytes(std::uint32_t{1}) + Bytes(1.0);
    for (int i = 0; i < 6; ++i) image += Bytes(0.0);
    image += Bytes(static_cast<std::uint32_t>(used)) + std::string("a.jpg") + '\0';
    folder_.Write("images.bin", image + Bytes(std::uint64_t{0}));
    folder_.Write("points3D.bin", Bytes(std::uint64_t{0}));
    return ReadColmapModel(folder_.path());
  }

  testing::TemporaryFolder folder_;

 private:
  template <typename T>
  static std::string Bytes(const T& value) {
    return {reinterpret_cast<const char*>(&value), sizeof(value)};
  }
  static std::string Camera(std::uint32_t id, std::int32_t model,
                            const std::vector<double>& params) {
    std::string bytes =
        Bytes(id) + Bytes(model) + Bytes(std::uint64_t{200}) + Bytes(std::uint64_t{100});
    for (const double param : params) bytes += Bytes(param);
    return bytes;
  }
};

TEST_P(CameraModels, AnUnusedCameraIsNoHindrance) {
  for (const auto& model : {ReadText(2), ReadBinary(2)}) {
    ASSERT_TRUE(model.ok()) << model.status().ToString();
    EXPECT_EQ(model->cameras.contains(1), GetParam().is_computed);
    EXPECT_EQ(model->cameras.at(2).principal_point_px(), Eigen::Vector2d(99.5, 49.5));
  }
}

TEST_P(CameraModels, AUsedOneIsComputedOrRefusedByName) {
  for (const auto& model : {ReadText(1), ReadBinary(1)}) {
    if (GetParam().is_computed) {
      ASSERT_TRUE(model.ok()) << model.status().ToString();
      EXPECT_EQ(model->cameras.at(1).focal_lengths_px().x(), 100);
      continue;
    }
    ASSERT_FALSE(model.ok());
    const std::string& message = model.status().message();
    EXPECT_THAT(message, HasSubstr("images."));
    EXPECT_THAT(message, HasSubstr("camera 1: camera model: '" + GetParam().name + "'"));
    const bool panorama = GetParam().name == "EQUIRECTANGULAR";
    EXPECT_THAT(message, HasSubstr(panorama ? "perspective views" : "colmap image_undistorter"));
  }
}

INSTANTIATE_TEST_SUITE_P(OfColmap4, CameraModels, ::testing::ValuesIn(kModels),
                         [](const auto& model) { return model.param.name; });

// COLMAP's other fisheyes are its OPENCV_FISHEYE with coefficients left out.
TEST(FisheyeModels, MissingCoefficientsAreZero) {
  const auto params = [](const std::string& model_and_params) {
    return ParseColmapCameraLine("1 " + model_and_params, "line")->params();
  };
  EXPECT_THAT(params("SIMPLE_FISHEYE 200 100 90 100.5 50.5"),
              ElementsAre(90, 90, 100, 50, 0, 0, 0, 0));
  EXPECT_THAT(params("FISHEYE 200 100 90 91 100.5 50.5"), ElementsAre(90, 91, 100, 50, 0, 0, 0, 0));
  EXPECT_THAT(params("SIMPLE_RADIAL_FISHEYE 200 100 90 100.5 50.5 0.1"),
              ElementsAre(90, 90, 100, 50, 0.1, 0, 0, 0));
  EXPECT_THAT(params("RADIAL_FISHEYE 200 100 90 100.5 50.5 0.1 0.2"),
              ElementsAre(90, 90, 100, 50, 0.1, 0.2, 0, 0));
  const Result<Camera> camera = ParseColmapCameraLine("1 SIMPLE_FISHEYE 200 100 90 100.5 50.5", "");
  const double angle = 0.5;  // equidistant: the radius is f times the angle
  const auto pixel = camera->Project({std::sin(angle), 0, std::cos(angle)});
  EXPECT_NEAR(pixel->x(), 100 + 90 * angle, 1e-9);
}

TEST(FisheyeModels, ACameraLineOfAnUnsupportedModelNamesTheCure) {
  const Result<Camera> camera =
      ParseColmapCameraLine("1 FOV 200 100 90 90 100 50 0.9", "cam.txt:1");
  EXPECT_THAT(camera.status().message(),
              HasSubstr("cam.txt:1: camera model: 'FOV' is not supported; undistort the photos"));
}

}  // namespace
}  // namespace maploc
