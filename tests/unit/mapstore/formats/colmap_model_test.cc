// A model folder that holds more than one model's three files.
#include <chrono>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/formats/colmap.h"
#include "tests/integration/tools/facade_model.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

class ColmapModelForms : public ::testing::Test {
 protected:
  ColmapModelForms() {
    Random random = testing::TestRandom();
    facade_ = testing::MakeFacade(random);
  }
  void WriteBinary() { testing::WriteBinaryModel(folder_.path(), facade_.model); }
  // `age` before now.
  void WriteText(std::chrono::hours age) {
    ASSERT_TRUE(WriteColmapModel(folder_.path(), facade_.model).ok());
    SetAge(age);
  }
  void SetAge(std::chrono::hours age) {
    for (const char* file : {"cameras.txt", "images.txt", "points3D.txt"}) {
      std::filesystem::last_write_time(folder_.File(file),
                                       std::filesystem::file_time_type::clock::now() - age);
    }
  }
  Result<ColmapModel> Read() { return ReadColmapModel(folder_.path()); }
  std::string Error() {
    const Result<ColmapModel> model = Read();
    return model.ok() ? "read" : model.status().message();
  }

  static constexpr std::chrono::hours kOlder{1};
  static constexpr std::chrono::hours kNewer{-1};
  testing::TemporaryFolder folder_;
  testing::FacadeModel facade_;
};

TEST_F(ColmapModelForms, OneFormNeedsNoNotice) {
  WriteText(kOlder);
  EXPECT_EQ(Read()->notice, "");
  EXPECT_EQ(Read()->points.size(), 60u);
}

TEST_F(ColmapModelForms, TheBinaryOneIsReadBesideAnOlderTextAndThatIsTold) {
  WriteBinary();
  facade_.model.points.erase(7);
  WriteText(kOlder);
  const Result<ColmapModel> model = Read();
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->points.size(), 60u);
  EXPECT_THAT(model->notice, HasSubstr(".bin files were read; the .txt files beside them are not"));
}

// `colmap model_converter` into the same folder.
TEST_F(ColmapModelForms, ANewerTextThatSaysTheSameIsNoHindrance) {
  WriteBinary();
  WriteText(kNewer);
  const Result<ColmapModel> model = Read();
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_THAT(model->notice, HasSubstr("say the same"));
}

TEST_F(ColmapModelForms, ANewerTextThatWasEditedIsRefusedWithWhatDiffers) {
  WriteBinary();
  const ColmapModel whole = facade_.model;
  const auto expect = [&](const std::string& difference) {
    WriteText(kNewer);
    EXPECT_THAT(Error(), HasSubstr("is newer than its .bin and differs (" + difference));
    EXPECT_THAT(Error(), HasSubstr("move away the files"));
    facade_.model = whole;
  };
  facade_.model.images.at(3).camera_from_source.translation.x() += 0.01;
  expect("image 3 has another pose");
  facade_.model.images.at(4).name = "renamed.jpg";
  expect("image 4 has another name");
  facade_.model.points.at(9).position_in_source.z() += 0.01;
  expect("point 9 has another position");
  facade_.model.cameras.at(1) =
      *Camera::Create(CameraModel::kPinhole, 1000, 800, {801, 800, 500, 400});
  expect("camera 1 has another calibration");
}

TEST_F(ColmapModelForms, ANewerTextThatLostOrWonAPartIsRefused) {
  WriteBinary();
  WriteText(kNewer);
  const std::string points = folder_.Read("points3D.txt");
  folder_.Write("points3D.txt", points + "1000 1 2 3 0 0 0 0\n");
  SetAge(kNewer);
  EXPECT_THAT(Error(), HasSubstr("there are more points there"));
  folder_.Write("points3D.txt", points + "1000 1 2\n");
  SetAge(kNewer);
  EXPECT_THAT(Error(), HasSubstr("points3D.txt:61: position: is missing"));
}

TEST_F(ColmapModelForms, ALoneNewerTextFileIsTold) {
  WriteBinary();
  WriteText(kNewer);
  std::filesystem::remove(folder_.File("points3D.txt"));
  const Result<ColmapModel> model = Read();
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_THAT(model->notice, HasSubstr("cameras.txt is newer, but there is no whole text model"));
  WriteText(kOlder);
  std::filesystem::remove(folder_.File("points3D.txt"));
  EXPECT_EQ(Read()->notice, "");
}

TEST_F(ColmapModelForms, RigsAndFramesOfColmap4AreNoHindrance) {
  WriteText(kOlder);
  folder_.Write("rigs.txt", "# Rig calib list\n1 1 CAMERA 1\n");
  folder_.Write("frames.txt", "# Frame list\n1 1 1 0 0 0 0 0 0 1 CAMERA 1 1\n");
  EXPECT_EQ(Error(), "read");
  WriteBinary();
  folder_.Write("rigs.bin", std::string(16, '\1'));
  folder_.Write("frames.bin", std::string(16, '\1'));
  EXPECT_EQ(Error(), "read");
}

}  // namespace
}  // namespace maploc
