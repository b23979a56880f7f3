// The forms that the same text takes after editors, spreadsheets and other programs had it, and
// what only looks like it: the former are read as the plain file is, the latter are refused with
// file and line.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/euroc.h"
#include "mapstore/formats/line_tracks.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

constexpr const char* kCameras = "# cameras\n1 PINHOLE 640 480 500 510 320.5 240.5\n";
constexpr const char* kImages =
    "# images\n"
    "1 1 0 0 0 1 2 3 1 my photo (1).jpg\n"
    "10.5 20.5 7 30.5 40.5 -1\n"
    "2 1 0 0 0 4 5 6 1 b.jpg\n"
    "\n"
    "3 1 0 0 0 7 8 9 1 c.jpg\n"
    "\n";
constexpr const char* kPoints = "# points\n7 0.25 -1 8 255 0 0 0.5 1 0\n";
constexpr const char* kGravity = "name,gx,gy,gz\nmy photo (1).jpg,0,0.6,-0.8\nb.jpg,1,0,0\n";
constexpr const char* kSensor =
    "resolution: [752, 480]\n"
    "camera_model: pinhole\n"
    "intrinsics: [458.654, 457.296, 367.215, 248.375]\n"
    "distortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]\n";
constexpr const char* kLines = "maploc-lines 1 binary2\n4 0 0 0 0 1 0 1 12 1 1234\n";

std::string Replace(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}
std::string Crlf(const std::string& text) { return Replace(text, "\n", "\r\n"); }
std::string Marked(const std::string& text) { return "\xEF\xBB\xBF" + text; }

// One file in place of a plain one of the same name.
struct Variant {
  std::string name;
  std::string file;
  std::string text;
};

class Folder {
 public:
  Folder() {
    for (const auto& [file, text] : {std::pair("cameras.txt", kCameras),
                                     {"images.txt", kImages},
                                     {"points3D.txt", kPoints},
                                     {"gravity.csv", kGravity},
                                     {"sensor.yaml", kSensor},
                                     {"lines.txt", kLines}}) {
      folder_.Write(file, text);
    }
  }
  void Write(const std::string& file, const std::string& text) { folder_.Write(file, text); }
  std::string File(const std::string& file) { return folder_.File(file); }

  // What the reader of `file` makes of it.
  Status Read(const std::string& file) {
    if (file == "gravity.csv") return ReadGravityCsv(File(file)).status();
    if (file == "sensor.yaml") return ReadEurocSensorYaml(File(file)).status();
    if (file == "lines.txt") return ReadLineTracks(File(file)).status();
    return ReadColmapModel(folder_.path()).status();
  }
  void ExpectPlainContent() {
    const auto model = ReadColmapModel(folder_.path());
    ASSERT_TRUE(model.ok()) << model.status().ToString();
    EXPECT_EQ(model->cameras.at(1).params(), (std::vector<double>{500, 510, 320, 240}));
    ASSERT_EQ(model->images.size(), 3u);
    EXPECT_EQ(model->images.at(1).name, "my photo (1).jpg");
    EXPECT_THAT(model->images.at(1).point_ids, ::testing::ElementsAre(7, -1));
    EXPECT_EQ(model->images.at(2).name, "b.jpg");
    EXPECT_TRUE(model->images.at(2).keypoints_px.empty());
    EXPECT_EQ(model->images.at(3).camera_from_source.translation, Eigen::Vector3d(7, 8, 9));
    EXPECT_EQ(model->points.at(7).position_in_source, Eigen::Vector3d(0.25, -1, 8));
    EXPECT_EQ(model->points.at(7).track.size(), 1u);
    const auto gravity = ReadGravityCsv(File("gravity.csv"));
    ASSERT_TRUE(gravity.ok()) << gravity.status().ToString();
    ASSERT_EQ(gravity->size(), 2u);
    EXPECT_LT((gravity->at("my photo (1).jpg") - Eigen::Vector3d(0, 0.6, -0.8)).norm(), 1e-12);
    const auto camera = ReadEurocSensorYaml(File("sensor.yaml"));
    ASSERT_TRUE(camera.ok()) << camera.status().ToString();
    EXPECT_EQ(camera->model(), CameraModel::kOpenCv);
    EXPECT_EQ(camera->params(), (std::vector<double>{458.654, 457.296, 367.215, 248.375, -0.28,
                                                     0.07, 0.0002, 0.00002}));
    const auto lines = ReadLineTracks(File("lines.txt"));
    ASSERT_TRUE(lines.ok()) << lines.status().ToString();
    EXPECT_EQ(lines->tracks.at(0).image_ids.at(0), 12);
  }

 private:
  testing::TemporaryFolder folder_;
};

class TextVariants : public ::testing::TestWithParam<Variant> {};

TEST_P(TextVariants, IsReadAsThePlainFileIs) {
  Folder folder;
  folder.Write(GetParam().file, GetParam().text);
  folder.ExpectPlainContent();
}

INSTANTIATE_TEST_SUITE_P(
    Of, TextVariants,
    ::testing::Values(
        Variant{"PlainCameras", "cameras.txt", kCameras},
        Variant{"MarkedCameras", "cameras.txt", Marked(kCameras)},
        Variant{"MarkedCamerasWithoutComment", "cameras.txt",
                Marked(Replace(kCameras, "# cameras\n", ""))},
        Variant{"CrlfCameras", "cameras.txt", Crlf(kCameras)},
        Variant{"CrCameras", "cameras.txt", Replace(kCameras, "\n", "\r")},
        Variant{"TabsAndSignsInCameras", "cameras.txt",
                Replace(Replace(kCameras, " ", "\t"), "500", "+5e2")},
        Variant{"MarkedCrlfImages", "images.txt", Marked(Crlf(kImages))},
        Variant{"NoLastBlankLine", "images.txt", Replace(kImages, "c.jpg\n\n", "c.jpg\n")},
        Variant{"NoLastLineEnd", "images.txt", Replace(kImages, "c.jpg\n\n", "c.jpg")},
        Variant{"NoBlankLines", "images.txt", Replace(kImages, "\n\n", "\n")},
        Variant{"NoBlankLinesCrlf", "images.txt", Crlf(Replace(kImages, "\n\n", "\n"))},
        Variant{"BlanksInsteadOfNothing", "images.txt", Replace(kImages, "\n\n", "\n  \t\n")},
        Variant{"MoreBlankLines", "images.txt", Replace(kImages, "b.jpg\n\n", "b.jpg\n\n\n\n")},
        Variant{"CrlfPoints", "points3D.txt", Crlf(kPoints)},
        Variant{"NanError", "points3D.txt", Replace(kPoints, "0.5", "nan")},
        Variant{"MinusNanError", "points3D.txt", Replace(kPoints, "0.5", "-nan")},
        Variant{"InfError", "points3D.txt", Replace(kPoints, "0.5", "inf")},
        Variant{"MarkedGravity", "gravity.csv", Marked(kGravity)},
        Variant{"CrlfGravity", "gravity.csv", Crlf(kGravity)},
        Variant{"HeaderWithBlanks", "gravity.csv",
                Replace(kGravity, "name,gx,gy,gz", " name, gx,\tgy , gz ")},
        Variant{"QuotedHeader", "gravity.csv",
                Replace(kGravity, "name,gx,gy,gz", "\"name\",\"gx\",\"gy\",\"gz\"")},
        Variant{"QuotedName", "gravity.csv",
                Replace(kGravity, "my photo (1).jpg", "\"my photo (1).jpg\" ")},
        Variant{"QuotedNumbers", "gravity.csv", Replace(kGravity, "0.6,", "\"0.6\" , ")},
        Variant{"MarkedSensor", "sensor.yaml", Marked(kSensor)},
        Variant{"CrlfSensor", "sensor.yaml", Crlf(kSensor)},
        Variant{"OpenCvsYaml", "sensor.yaml", "%YAML:1.0\n---\n" + std::string(kSensor)},
        Variant{"Radtan", "sensor.yaml", Replace(kSensor, "radial-tangential", "radtan")},
        Variant{"QuotedValues", "sensor.yaml",
                Replace(Replace(kSensor, "pinhole", "\"pinhole\""), "radial-tangential",
                        "'radial-tangential'  # Brown")},
        Variant{"BlankBeforeColon", "sensor.yaml", Replace(kSensor, ":", " :")},
        Variant{"ListOnTwoLines", "sensor.yaml", Replace(kSensor, "457.296, ", "457.296,\n  ")},
        Variant{"ListWithDashes", "sensor.yaml",
                Replace(kSensor, "[752, 480]", "\n  - 752\n  - 480")},
        Variant{"KalibrsCamchain", "sensor.yaml",
                "cam0:\n  " +
                    Replace(Replace(Replace(kSensor, "\n", "\n  "), "_coefficients", "_coeffs"),
                            "radial-tangential", "radtan")},
        Variant{"MarkedLines", "lines.txt", Marked(kLines)},
        Variant{"CrlfLines", "lines.txt", Crlf(kLines)}),
    [](const auto& variant) { return variant.param.name; });

TEST(TextVariants, EquidistantIsAFisheye) {
  Folder folder;
  for (const std::string model : {"equidistant", "equi"}) {
    folder.Write("sensor.yaml", Replace(kSensor, "radial-tangential", model));
    const auto camera = ReadEurocSensorYaml(folder.File("sensor.yaml"));
    ASSERT_TRUE(camera.ok()) << camera.status().ToString();
    EXPECT_EQ(camera->model(), CameraModel::kOpenCvFisheye);
  }
}

TEST(TextVariants, QuotesKeepCommasAndQuotesInNames) {
  Folder folder;
  folder.Write("gravity.csv", "\"a, \"\"b\"\".jpg\",0,0,1\nc, d.jpg,0,0,1\n5\" e.jpg,0,0,1\n");
  const auto gravity = ReadGravityCsv(folder.File("gravity.csv"));
  ASSERT_TRUE(gravity.ok()) << gravity.status().ToString();
  for (const char* name : {"a, \"b\".jpg", "c, d.jpg", "5\" e.jpg"}) {
    EXPECT_TRUE(gravity->contains(name)) << name;
  }
}

TEST(TextVariants, ACameraLineMayCarryTheMark) {
  EXPECT_TRUE(ParseColmapCameraLine(Marked("1 PINHOLE 64 48 50 50 32 24\r"), "camera.txt:1").ok());
}

struct Hostile {
  std::string name;
  std::string file;
  std::string text;
  int line;
  std::string cause;
};

class HostileText : public ::testing::TestWithParam<Hostile> {};

TEST_P(HostileText, IsRefusedWithFileAndLine) {
  Folder folder;
  folder.Write(GetParam().file, GetParam().text);
  const Status status = folder.Read(GetParam().file);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(folder.File(GetParam().file) + ":" +
                                          std::to_string(GetParam().line) + ": "));
  EXPECT_THAT(status.message(), HasSubstr(GetParam().cause));
  EXPECT_EQ(status.message().find('\n'), std::string::npos);
}

std::string Utf16(const std::string& text) {
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  return wide;
}

INSTANTIATE_TEST_SUITE_P(
    Of, HostileText,
    ::testing::Values(
        Hostile{"Utf16Cameras", "cameras.txt", Utf16(kCameras), 1, "UTF-16"},
        Hostile{"NulInCameras", "cameras.txt", std::string(kCameras) + '\0', 3, "NUL byte"},
        Hostile{"CommaDecimals", "cameras.txt", Replace(kCameras, "320.5", "320,5"), 2,
                "'320,5' is not a number"},
        Hostile{"HexFocal", "cameras.txt", Replace(kCameras, "500", "0x1F4"), 2, "'0x1F4'"},
        Hostile{"TwoSigns", "cameras.txt", Replace(kCameras, "500", "+-500"), 2, "'+-500'"},
        Hostile{"NanFocal", "cameras.txt", Replace(kCameras, "500", "nan"), 2, "is not finite"},
        Hostile{"EndlessSide", "cameras.txt", Replace(kCameras, "640", "99999999999999999999"), 2,
                "is not a number"},
        Hostile{"ParameterMissing", "cameras.txt", Replace(kCameras, " 240.5", ""), 2,
                "PINHOLE takes 4 parameters, got 3"},
        Hostile{"TwoKeypointsCut", "images.txt", Replace(kImages, "40.5 -1", "40.5"), 3,
                "keypoint's point id: is missing"},
        Hostile{"HeaderCut", "images.txt", Replace(kImages, "4 5 6 1 b.jpg", "4 5"), 4,
                "translation: is missing"},
        Hostile{"ZeroQuaternion", "images.txt", Replace(kImages, "2 1 0 0 0", "2 0 0 0 0"), 4,
                "quaternion"},
        Hostile{"NanPose", "images.txt", Replace(kImages, "4 5 6", "nan 5 6"), 4, "not finite"},
        Hostile{"ImageTwice", "images.txt", std::string(kImages) + "1 1 0 0 0 0 0 0 1 d.jpg\n\n", 9,
                "image id: 1 stands twice"},
        Hostile{"UnknownPoint", "images.txt", Replace(kImages, "20.5 7", "20.5 8"), 3,
                "point 8 is not among the points"},
        Hostile{"KeypointsWithoutHeader", "images.txt",
                Replace(kImages, "b.jpg\n\n", "b.jpg\n\n1 2 -1\n"), 6, "is missing"},
        Hostile{"WordAsError", "points3D.txt", Replace(kPoints, "0.5", "none"), 2, "'none'"},
        Hostile{"NanPosition", "points3D.txt", Replace(kPoints, "0.25", "nan"), 2, "not finite"},
        Hostile{"FarPosition", "points3D.txt", Replace(kPoints, "0.25", "1e300"), 2, "1e12"},
        Hostile{"TrackCut", "points3D.txt", Replace(kPoints, "0.5 1 0", "0.5 1"), 2,
                "track's keypoint: is missing"},
        Hostile{"KeypointBeyond", "points3D.txt", Replace(kPoints, "0.5 1 0", "0.5 1 4294967295"),
                2, "keypoint"},
        Hostile{"OpenQuote", "gravity.csv", Replace(kGravity, "my photo", "\"my photo"), 2,
                "a quote is not closed"},
        Hostile{"TextAfterQuote", "gravity.csv", Replace(kGravity, "b.jpg", "\"b\".jpg"), 3,
                "goes on after a closing quote"},
        Hostile{"Semicolons", "gravity.csv", Replace(kGravity, ",", ";"), 1, "name,gx,gy,gz"},
        Hostile{"AnotherHeader", "gravity.csv", Replace(kGravity, "name,gx", "time,ax"), 1,
                "'ax' is not a number"},
        Hostile{"Accelerations", "gravity.csv", Replace(kGravity, "b.jpg,1", "b.jpg,4.2"), 3,
                "the length 4.2"},
        Hostile{"Utf16Gravity", "gravity.csv", Utf16(kGravity), 1, "UTF-16"},
        Hostile{"OmniCamera", "sensor.yaml", Replace(kSensor, "pinhole", "omni"), 2, "'omni'"},
        Hostile{"UnknownDistortion", "sensor.yaml", Replace(kSensor, "radial-tangential", "fov"), 4,
                "'fov'"},
        Hostile{"OpenList", "sensor.yaml", Replace(kSensor, "248.375]", "248.375"), 3,
                "list of 4 numbers"},
        Hostile{"FiveCoefficients", "sensor.yaml", Replace(kSensor, "[-0.28", "[-0.28, 0"), 5,
                "list of 4 numbers"},
        Hostile{"ZeroFocal", "sensor.yaml", Replace(kSensor, "458.654", "0"), 3, "focal length"},
        Hostile{"TwoCameras", "sensor.yaml", std::string(kSensor) + kSensor, 6, "stands twice"},
        Hostile{"BinaryLines", "lines.txt", std::string("maploc-lines 1 lbd\n\0\1", 21), 2,
                "NUL byte"},
        Hostile{"NanLine", "lines.txt", Replace(kLines, "4 0", "4 nan"), 2, "not finite"}),
    [](const auto& hostile) { return hostile.param.name; });

}  // namespace
}  // namespace maploc
