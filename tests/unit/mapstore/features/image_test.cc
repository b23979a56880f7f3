// Pictures as files: whole, cut, and with more than eight bits.
#include "mapstore/features/image.h"

#include <algorithm>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

// A grey ramp with noise, so that it does not compress to nothing.
cv::Mat Picture(int type, int highest) {
  Random random = testing::TestRandom();
  cv::Mat picture(96, 128, type);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double value = highest * (x / 127.0 * 0.9 + random.Uniform(0, 0.1));
      if (type == CV_8UC1) {
        picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(value);
      } else {
        picture.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(value);
      }
    }
  }
  return picture;
}

TEST(LoadGrayImageTest, ReadsPixelsAndNamesABadFile) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("load.pgm");
  folder.Write("load.pgm", "P5 3 2 255\nabcdef");
  const Result<GrayImage> image = LoadGrayImage(path);
  ASSERT_TRUE(image.ok()) << image.status().ToString();
  EXPECT_EQ(image->width_px, 3);
  EXPECT_EQ(image->height_px, 2);
  EXPECT_EQ(std::string(image->pixels.begin(), image->pixels.end()), "abcdef");
  folder.Write("load.pgm", "no picture");
  EXPECT_THAT(LoadGrayImage(path).status().message(), HasSubstr(path));
  std::remove(path.c_str());
  EXPECT_THAT(LoadGrayImage(path).status().message(), HasSubstr(path));
}

// The decoder would fill up with grey, and whoever asked for the picture would not know.
TEST(LoadGrayImageTest, ACutPictureIsRefusedByName) {
  const testing::TemporaryFolder folder;
  for (const std::string extension : {"jpg", "png", "tif", "bmp", "pgm", "webp"}) {
    const std::string path = folder.File("photo." + extension);
    cv::imwrite(path, Picture(CV_8UC1, 255));
    const std::string whole = testing::ReadFile(path);
    ASSERT_TRUE(LoadGrayImage(path).ok()) << extension;
    for (const double share : {0.2, 0.5, 0.9}) {
      const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
      testing::WriteFile(path, whole.substr(0, size));
      const Result<GrayImage> image = LoadGrayImage(path);
      ASSERT_FALSE(image.ok()) << extension << " cut to " << share;
      EXPECT_THAT(image.status().message(), HasSubstr(path));
      if (extension != "jpg" && extension != "png") continue;
      EXPECT_EQ(image.status().reason(), kTruncatedImage);
    }
  }
}

// Whole by its marks, so that only its size is wrong.
TEST(LoadGrayImageTest, APictureOfTooManyPixelsIsRefusedWithSizeLimitAndCure) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("panorama.png");
  cv::imwrite(path, Picture(CV_8UC1, 255));
  std::string bytes = testing::ReadFile(path);
  bytes.replace(16, 8, std::string("\x00\x00\x9c\x40\x00\x00\x75\x30", 8));
  testing::WriteFile(path, bytes);
  const std::string message = LoadGrayImage(path).status().message();
  for (const std::string& part : {path, std::string("is 40000x30000 pixels"),
                                  std::string("1,073,741,824"), std::string("-resize 50%")}) {
    EXPECT_THAT(message, HasSubstr(part));
  }
}

// Of whole files the end alone is read, of others as much as is needed.
TEST(CheckWholeTest, SeesACutPictureWithoutDecodingIt) {
  const testing::TemporaryFolder folder;
  for (const std::string extension : {"jpg", "png"}) {
    const std::string path = folder.File("photo." + extension);
    cv::imwrite(path, Picture(CV_8UC1, 255));
    const std::string whole = testing::ReadFile(path);
    EXPECT_TRUE(CheckWhole(path).ok());
    testing::WriteFile(path, whole + "a phone's video");
    EXPECT_TRUE(CheckWhole(path).ok());
    for (const std::size_t size : {whole.size() / 2, whole.size() - 1, std::size_t{9}}) {
      testing::WriteFile(path, whole.substr(0, size));
      const Status status = CheckWhole(path);
      EXPECT_EQ(status.reason(), kTruncatedImage) << extension << " of " << size << " bytes";
      EXPECT_THAT(status.message(), HasSubstr(path));
    }
  }
  testing::WriteFile(folder.File("empty.jpg"), "");
  for (const char* other : {"empty.jpg", "absent.jpg", "."}) {
    EXPECT_TRUE(CheckWhole(folder.File(other)).ok()) << other << " is no cut picture";
  }
}

TEST(LoadGrayImageTest, WhatFollowsAPictureAndAThumbnailInsideDoNotMatter) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("photo.jpg");
  for (const int progressive : {0, 1}) {
    cv::imwrite(path, Picture(CV_8UC1, 255),
                {cv::IMWRITE_JPEG_PROGRESSIVE, progressive, cv::IMWRITE_JPEG_RST_INTERVAL, 4});
    const std::string whole = testing::ReadFile(path);
    // An application segment that holds a whole picture, as cameras store their thumbnails.
    const std::string thumbnail = whole.substr(0, 2) + "\xFF\xD9";
    const auto length = static_cast<char>(thumbnail.size() + 2);
    const std::string segment = std::string("\xFF\xE1\0", 3) + length + thumbnail;
    const std::string photo = whole.substr(0, 2) + segment + whole.substr(2);
    testing::WriteFile(path, photo + "a phone's video");
    EXPECT_TRUE(LoadGrayImage(path).ok());
    testing::WriteFile(path, photo.substr(0, photo.size() / 2));
    EXPECT_EQ(LoadGrayImage(path).status().reason(), kTruncatedImage);
  }
}

TEST(LoadGrayImageTest, SensorBitsInSixteenAreScaledByTheRangeThatIsUsed) {
  const testing::TemporaryFolder folder;
  const Result<GrayImage> eight = [&] {
    cv::imwrite(folder.File("8.png"), Picture(CV_8UC1, 255));
    return LoadGrayImage(folder.File("8.png"));
  }();
  for (const int bits : {10, 12, 14, 16}) {
    for (const std::string extension : {"png", "tif", "pgm"}) {
      const std::string path = folder.File(std::to_string(bits) + "." + extension);
      cv::imwrite(path, Picture(CV_16UC1, (1 << bits) - 1));
      const Result<GrayImage> image = LoadGrayImage(path);
      ASSERT_TRUE(image.ok()) << image.status().ToString();
      ASSERT_EQ(image->pixels.size(), eight->pixels.size());
      for (std::size_t i = 0; i < image->pixels.size(); ++i) {
        ASSERT_NEAR(image->pixels[i], eight->pixels[i], 2) << path << ", pixel " << i;
      }
    }
  }
}

// Eight bits stay what they are, dark or not: exposure is the photographer's.
TEST(LoadGrayImageTest, EightBitsAreNotScaled) {
  const testing::TemporaryFolder folder;
  cv::imwrite(folder.File("dark.png"), Picture(CV_8UC1, 20));
  const Result<GrayImage> image = LoadGrayImage(folder.File("dark.png"));
  EXPECT_LE(*std::max_element(image->pixels.begin(), image->pixels.end()), 20);
}

}  // namespace
}  // namespace maploc
