#include "client/robot/camera_file.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

// Cameras are told apart by their widths: camera N is 100 N wide.
class CameraFileTest : public ::testing::Test {
 protected:
  CameraFileTest() {
    std::filesystem::create_directories(folder_.File("photos/left"));
    std::filesystem::create_directories(folder_.File("photos/right"));
    folder_.Write("cameras.txt", "# id\n" + Line(1) + Line(2) + Line(7));
    folder_.Write("images.txt",
                  "# two lines an image\n1 1 0 0 0 0 0 0 2 left/a b.jpg\n10 10 -1\n"
                  "2 1 0 0 0 0 0 0 7 right/a b.jpg\n\n3 1 0 0 0 0 0 0 1 b.jpg\n\n");
  }
  static std::string Line(int id) {
    return std::to_string(id) + " PINHOLE " + std::to_string(100 * id) + " 50 50 50 32 24\n";
  }
  Result<Camera> Read(const std::string& photo, std::optional<std::int64_t> id = std::nullopt) {
    return ReadCameraFile({folder_.File("cameras.txt"), folder_.File(photo), id});
  }

  testing::TemporaryFolder folder_;
};

TEST_F(CameraFileTest, APhotoHasTheCameraThatTheModelGivesIt) {
  EXPECT_EQ(Read("photos/left/a b.jpg")->width_px(), 200);
  EXPECT_EQ(Read("photos/right/a b.jpg")->width_px(), 700);
  EXPECT_EQ(Read("photos/b.jpg")->width_px(), 100);
  EXPECT_EQ(Read("photos/left/../right/a b.jpg")->width_px(), 700);
}

TEST_F(CameraFileTest, TheFlagDecidesOverTheModel) {
  EXPECT_EQ(Read("photos/b.jpg", 7)->width_px(), 700);
  EXPECT_EQ(Read("photos/new.jpg", 2)->width_px(), 200);
  const Status absent = Read("photos/b.jpg", 3).status();
  EXPECT_EQ(absent.reason(), "NO_CAMERA");
  EXPECT_THAT(absent.message(), HasSubstr("no camera 3, only 1, 2, 7"));
}

TEST_F(CameraFileTest, OfSeveralNoneIsGuessed) {
  // A new photo; the end of a name alone; a photo whose folder the model does not know.
  for (const char* photo : {"photos/new.jpg", "photos/left/xa b.jpg", "photos/a b.jpg"}) {
    const Status status = Read(photo).status();
    EXPECT_EQ(status.reason(), "AMBIGUOUS_CAMERA") << photo;
    EXPECT_THAT(status.message(), HasSubstr("3 cameras (1, 2, 7)"));
    EXPECT_THAT(status.message(), HasSubstr("--camera-id N"));
  }
  std::filesystem::remove(folder_.File("images.txt"));
  EXPECT_EQ(Read("photos/b.jpg").status().reason(), "AMBIGUOUS_CAMERA");
}

TEST_F(CameraFileTest, AModelsFolderServesAsWell) {
  folder_.Write("points3D.txt", "");
  const Result<Camera> camera =
      ReadCameraFile({folder_.path(), folder_.File("photos/left/a b.jpg"), std::nullopt});
  ASSERT_TRUE(camera.ok()) << camera.status().ToString();
  EXPECT_EQ(camera->width_px(), 200);
  EXPECT_EQ(ReadCameraFile({folder_.path(), "new.jpg", std::nullopt}).status().reason(),
            "AMBIGUOUS_CAMERA");
}

TEST_F(CameraFileTest, TheOnlyCameraIsEveryPhotos) {
  folder_.Write("cameras.txt", Line(4));
  EXPECT_EQ(Read("photos/new.jpg")->width_px(), 400);
  EXPECT_EQ(Read("photos/new.jpg", 4)->width_px(), 400);
  EXPECT_EQ(Read("photos/new.jpg", 1).status().reason(), "NO_CAMERA");
}

TEST_F(CameraFileTest, AnEurocFileIsToldByItsNameInAnyCase) {
  for (const char* name : {"s.yaml", "s.yml", "s.YAML", "s.Yml"}) {
    for (const char* mark : {"", "\xEF\xBB\xBF"}) {
      for (const auto& [distortion, model] :
           {std::pair("radial-tangential", CameraModel::kOpenCv),
            std::pair("radtan", CameraModel::kOpenCv),
            std::pair("equidistant", CameraModel::kOpenCvFisheye)}) {
        folder_.Write(name, std::string(mark) +
                                "camera_model: pinhole\nresolution: [640, 480]\n"
                                "intrinsics: [500, 500, 320, 240]\ndistortion_model: " +
                                distortion + "\ndistortion_coefficients: [0.01, 0, 0, 0]\n");
        const Result<Camera> camera = ReadCameraFile({folder_.File(name), "a.jpg", std::nullopt});
        ASSERT_TRUE(camera.ok()) << name << " " << distortion << camera.status().ToString();
        EXPECT_EQ(camera->model(), model);
      }
    }
  }
}

TEST_F(CameraFileTest, OneCameraNeedsNoId) {
  folder_.Write("s.yaml", "");
  const Status status = ReadCameraFile({folder_.File("s.yaml"), "a.jpg", 1}).status();
  EXPECT_THAT(status.message(), HasSubstr("leave it out"));
}

// As Windows' editors write them.
TEST_F(CameraFileTest, AByteOrderMarkIsPassedOver) {
  for (const char* name : {"cameras.txt", "images.txt"}) {
    const std::string text = folder_.Read(name);
    folder_.Write(name, "\xEF\xBB\xBF" + text.substr(text.find('\n') + 1));  // no comment first
  }
  EXPECT_EQ(Read("photos/left/a b.jpg")->width_px(), 200);
  EXPECT_EQ(Read("photos/b.jpg", 1)->width_px(), 100);
}

// A camera that nobody asks for need not be one that maploc knows.
TEST_F(CameraFileTest, AnErrorNamesTheLineAndOnlyTheWantedOneCounts) {
  folder_.Write("cameras.txt", Line(1) + "2 FOV 64 48 50 50 32 24 0.1\n");
  EXPECT_EQ(Read("photos/b.jpg")->width_px(), 100);
  EXPECT_THAT(Read("photos/b.jpg", 2).status().message(), HasSubstr("cameras.txt:2"));
  folder_.Write("cameras.txt", Line(1) + Line(1));
  EXPECT_THAT(Read("photos/b.jpg").status().message(), HasSubstr("cameras.txt:2: camera 1 stands"));
  folder_.Write("cameras.txt", std::string("SQLite format 3\0\n\n\1\n", 20));
  EXPECT_THAT(Read("photos/b.jpg").status().message(), HasSubstr("cameras.txt:1: is no camera;"));
  folder_.Write("cameras.txt", "\n# nothing\n");
  EXPECT_THAT(Read("photos/b.jpg").status().message(), HasSubstr("holds no camera"));
}

}  // namespace
}  // namespace maploc
