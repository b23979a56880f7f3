#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/euroc.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

class GravityCsvTest : public ::testing::Test {
 protected:
  auto Read(const std::string& text) {
    folder_.Write("gravity.csv", text);
    return ReadGravityCsv(folder_.File("gravity.csv"));
  }
  std::string Error(const std::string& text) {
    const auto gravity = Read(text);
    return gravity.ok() ? "read" : gravity.status().message();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(GravityCsvTest, ReadsUnitVectorsByName) {
  const auto gravity = Read("# from the IMU\nname,gx,gy,gz\na,b.png,0,0.6,-0.8\nc.png, 1 ,0,0\r\n");
  ASSERT_TRUE(gravity.ok()) << gravity.status().ToString();
  EXPECT_TRUE(gravity->at("a,b.png").isApprox(Eigen::Vector3d(0, 0.6, -0.8)));
  EXPECT_EQ(gravity->at("c.png"), Eigen::Vector3d(1, 0, 0));
}

TEST_F(GravityCsvTest, NamesTheLineOfABrokenRow) {
  EXPECT_THAT(Error("name,gx,gy,gz\na,0,1\n"), HasSubstr("gravity.csv:2: row"));
  EXPECT_THAT(Error("a,0,x,0\n"), HasSubstr("gravity.csv:1: gravity: 'x' is not a number"));
  EXPECT_THAT(Error("a,0,0,0\n"), HasSubstr("is zero"));
  EXPECT_THAT(Error("a,nan,0,0\n"), HasSubstr("is not finite"));
  EXPECT_THAT(Error(",0,1,0\n"), HasSubstr("name: is missing"));
  EXPECT_THAT(Error("a,0,1,0\na,0,1,0\n"), HasSubstr("gravity.csv:2: image 'a' stands twice"));
  EXPECT_THAT(Error("# empty\n"), HasSubstr("holds no row"));
  EXPECT_EQ(ReadGravityCsv(folder_.File("absent")).status().code(), StatusCode::kNotFound);
}

constexpr const char* kSensor =
    "# General sensor definitions.\n"
    "sensor_type: camera\n"
    "T_BS:\n"
    "  cols: 4\n"
    "  data: [0.0148655429818, -0.999880929698,\n"
    "         0.0, 1.0]\n"
    "rate_hz: 20\n"
    "resolution: [752, 480]\n"
    "camera_model: pinhole\n"
    "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n"
    "distortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";

class EurocTest : public ::testing::Test {
 protected:
  Result<Camera> Read(const std::string& text) {
    folder_.Write("sensor.yaml", text);
    return ReadEurocSensorYaml(folder_.File("sensor.yaml"));
  }
  // The error when `from` in the good file is replaced.
  std::string Error(const std::string& from, const std::string& to) {
    std::string text = kSensor;
    text.replace(text.find(from), from.size(), to);
    const Result<Camera> camera = Read(text);
    return camera.ok() ? "read" : camera.status().message();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(EurocTest, ReadsTheDataSetsOwnCalibration) {
  const Result<Camera> camera = Read(kSensor);
  ASSERT_TRUE(camera.ok()) << camera.status().ToString();
  EXPECT_EQ(camera->model(), CameraModel::kOpenCv);
  EXPECT_EQ(camera->width_px(), 752);
  EXPECT_EQ(camera->height_px(), 480);
  EXPECT_EQ(camera->principal_point_px(), Eigen::Vector2d(367.215, 248.375));
  EXPECT_EQ(camera->params()[7], 1.76187114e-05);
}

TEST_F(EurocTest, NamesWhatIsWrong) {
  EXPECT_THAT(Error("camera_model", "camera"), HasSubstr("has no line 'camera_model"));
  EXPECT_THAT(Error("pinhole", "omni"), HasSubstr("sensor.yaml:9: camera_model 'omni'"));
  EXPECT_THAT(Error("radial-tangential", "fov"), HasSubstr("sensor.yaml:11: distortion_model"));
  EXPECT_THAT(Error("458.654", "0"), HasSubstr("focal length"));
  EXPECT_THAT(Error("458.654", "nan"), HasSubstr("sensor.yaml:10: "));
  EXPECT_THAT(Error("458.654, ", ""), HasSubstr("list of 4 numbers"));
  EXPECT_THAT(Error("458.654, 457", "458.654,, 457"), HasSubstr("list of 4 numbers"));
  EXPECT_THAT(Error("[752, 480]", "[752.5, 480]"), HasSubstr("two whole numbers"));
  EXPECT_THAT(Error("[752, 480]", "[1e99, 480]"), HasSubstr("two whole numbers"));
  EXPECT_THAT(Error("rate_hz: 20", "resolution: [1, 1]"), HasSubstr("stands twice"));
}

}  // namespace
}  // namespace maploc
