#include "mapstore/features/photo_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Bytes(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes.push_back(static_cast<char>(value));
  return bytes;
}

std::string Exif(int orientation, bool big_endian) {
  const std::string tiff =
      big_endian ? std::string("MM") +
                       Bytes({0, 42, 0, 0, 0, 8,    0, 2, 1, 0x0f, 0, 2, 0, 0,           0, 0,
                              0, 0,  0, 0, 1, 0x12, 0, 3, 0, 0,    0, 1, 0, orientation, 0, 0})
                 : std::string("II") +
                       Bytes({42, 0, 8, 0, 0,    0, 2, 0, 0x0f, 1, 2, 0, 0,           0, 0, 0,
                              0,  0, 0, 0, 0x12, 1, 3, 0, 1,    0, 0, 0, orientation, 0, 0, 0});
  return std::string("Exif\0\0", 6) + tiff;
}

std::string Segment(int marker, const std::string& content) {
  const int length = static_cast<int>(content.size()) + 2;
  return Bytes({0xff, marker, length >> 8, length & 0xff}) + content;
}

// The start of a JPEG of 400 x 300 pixels, up to its frame header.
std::string Jpeg(const std::string& exif) {
  return Bytes({0xff, 0xd8}) + Segment(0xe0, "JFIF") + (exif.empty() ? "" : Segment(0xe1, exif)) +
         Segment(0xc4, "tables") + Segment(0xc2, Bytes({8, 1, 0x2c, 1, 0x90, 1}));
}

class PhotoHeaderTest : public ::testing::Test {
 protected:
  std::optional<PhotoHeader> Read(const std::string& bytes) {
    folder_.Write("photo", bytes);
    return ReadPhotoHeader(Path());
  }
  std::string Path() const { return folder_.File("photo"); }
  static Camera CameraOf(int width_px, int height_px) {
    return *Camera::Create(CameraModel::kPinhole, width_px, height_px, {50, 50, 32, 24});
  }

  testing::TemporaryFolder folder_;
};

TEST_F(PhotoHeaderTest, ReadsSizeAndOrientationInBothByteOrders) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    for (const bool big_endian : {false, true}) {
      const auto header = Read(Jpeg(Exif(orientation, big_endian)));
      ASSERT_TRUE(header.has_value());
      EXPECT_EQ(header->width_px, 400);
      EXPECT_EQ(header->height_px, 300);
      EXPECT_EQ(header->orientation, orientation);
    }
  }
  EXPECT_EQ(Read(Jpeg(""))->orientation, 1);
  const auto png = Read("\x89PNG\r\n\x1a\n" + Bytes({0, 0, 0, 13}) + "IHDR" +
                        Bytes({0, 0, 1, 0x90, 0, 0, 1, 0x2c}));
  EXPECT_EQ(png->width_px, 400);
  EXPECT_EQ(png->height_px, 300);
}

// Any number of bytes FF may stand before a marker.
TEST_F(PhotoHeaderTest, FillBytesBeforeAMarkerArePassedOver) {
  const std::string fill(3, '\xff');
  const auto header =
      Read(Bytes({0xff, 0xd8}) + fill + Segment(0xe0, "JFIF") + fill +
           Segment(0xe1, Exif(6, true)) + fill + Segment(0xc2, Bytes({8, 1, 0x2c, 1, 0x90, 1})));
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->width_px, 400);
  EXPECT_EQ(header->height_px, 300);
  EXPECT_EQ(header->orientation, 6);
  EXPECT_FALSE(Read(Bytes({0xff, 0xd8}) + std::string(1000, '\xff')).has_value());
}

TEST_F(PhotoHeaderTest, EveryPrefixOfAFileIsReadWithoutHarm) {
  const std::string whole = Jpeg(Exif(6, true));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto header = Read(whole.substr(0, size));
    if (header) {
      EXPECT_EQ(header->orientation, 6);
    }
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = '\xff';
    const auto header = Read(changed);
    if (header) {
      EXPECT_LE(header->orientation, 8);
    }
  }
}

TEST_F(PhotoHeaderTest, AWrongSizeTellsBothAndWhatTheOrientationHasToDoWithIt) {
  Read(Jpeg(Exif(6, true)));
  const std::string turned =
      CheckPhotoSize(Path(), 400, 300, CameraOf(300, 400), "cameras.txt").message();
  for (const char* said : {"400x300 pixels as stored", "cameras.txt is 300x400",
                           "EXIF orientation 6 shows it as 300x400", "exiftran"}) {
    EXPECT_THAT(turned, HasSubstr(said));
  }
  Read(Jpeg(""));
  const std::string plain =
      CheckPhotoSize(Path(), 400, 300, CameraOf(640, 480), "cameras.txt").message();
  EXPECT_THAT(plain, HasSubstr("400x300"));
  EXPECT_THAT(plain, HasSubstr("640x480"));
  EXPECT_THAT(plain, Not(HasSubstr("EXIF")));
  EXPECT_TRUE(CheckPhotoSize(Path(), 400, 300, CameraOf(400, 300), "cameras.txt").ok());
}

// Orientation 6: the shown photo is the stored one turned clockwise, so that right becomes down.
TEST_F(PhotoHeaderTest, TellsWhereDownIsInTheStoredPixels) {
  EXPECT_EQ(Read(Jpeg(Exif(1, true)))->ShownDown(), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(OrientationNote(Path()), "");
  EXPECT_EQ(Read(Jpeg(Exif(3, true)))->ShownDown(), Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(Read(Jpeg(Exif(8, true)))->ShownDown(), Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(Read(Jpeg(Exif(6, true)))->ShownDown(), Eigen::Vector3d(1, 0, 0));
  EXPECT_THAT(OrientationNote(Path()), HasSubstr("down is about 1,0,0"));
}

}  // namespace
}  // namespace maploc
