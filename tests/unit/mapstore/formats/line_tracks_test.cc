#include "mapstore/formats/line_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class LineTracksTest : public ::testing::Test {
 protected:
  Result<LineTracks> Read(const std::string& text) {
    testing::WriteFile(path_, text);
    return ReadLineTracks(path_);
  }
  // The error of a file whose second line is `record`; it must name that line.
  std::string Error(const std::string& record) {
    const Result<LineTracks> tracks = Read("maploc-lines 1 binary2\n" + record + "\n");
    if (tracks.ok()) return "read";
    EXPECT_EQ(tracks.status().code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(tracks.status().message(), HasSubstr(path_ + ":2: "));
    return tracks.status().message();
  }

  testing::TemporaryFolder folder_;
  std::string path_ = folder_.File("lines.txt");
};

TEST_F(LineTracksTest, ReadsGeometryTracksAndDescriptors) {
  const Result<LineTracks> tracks = Read(
      "# a comment\n\n"
      "maploc-lines 1 binary2  # the kind\n"
      "7  0 1.5 -2  1e1 1 -2  2 11 12  2 00ff A0b1\n"
      "3 0 0 0 0 0 1  1 11  0\n"
      "4 0 0 0 0 1 0  1 12  1 1234\n");
  ASSERT_TRUE(tracks.ok()) << tracks.status().ToString();
  ASSERT_EQ(tracks->tracks.size(), 3u);
  EXPECT_EQ(tracks->tracks[0].id, 7);
  EXPECT_EQ(tracks->tracks[0].segment_in_source.start, Eigen::Vector3d(0, 1.5, -2));
  EXPECT_EQ(tracks->tracks[0].segment_in_source.end, Eigen::Vector3d(10, 1, -2));
  EXPECT_THAT(tracks->tracks[0].image_ids, ElementsAre(11, 12));
  EXPECT_EQ(tracks->descriptors.kind.name, "binary2");
  EXPECT_THAT(tracks->descriptors.bytes, ElementsAre(0x00, 0xff, 0xa0, 0xb1, 0x12, 0x34));
  EXPECT_THAT(tracks->descriptor_track, ElementsAre(0, 0, 2));
}

TEST_F(LineTracksTest, WritesWhatItReads) {
  LineTracks written;
  written.descriptors.kind = *DescriptorKindFromName("lbd");
  written.descriptors.bytes.assign(64, 0x5a);
  written.descriptors.bytes[40] = 0x0f;
  written.descriptor_track = {0, 1};
  written.tracks.push_back({0, {{0.1, 1.0 / 3.0, -1e-9}, {4, 5, 6}}, {1, 2, 3}});
  written.tracks.push_back({1, {{1, 2, 3}, {4, 5, 6e20}}, {9}});
  ASSERT_TRUE(WriteLineTracks(path_, written).ok());
  const Result<LineTracks> read = ReadLineTracks(path_);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  ASSERT_EQ(read->tracks.size(), 2u);
  EXPECT_EQ(read->tracks[0].segment_in_source.start, written.tracks[0].segment_in_source.start);
  EXPECT_EQ(read->tracks[1].segment_in_source.end, written.tracks[1].segment_in_source.end);
  EXPECT_EQ(read->tracks[0].image_ids, written.tracks[0].image_ids);
  EXPECT_EQ(read->descriptors.bytes, written.descriptors.bytes);
  EXPECT_EQ(read->descriptor_track, written.descriptor_track);
}

TEST_F(LineTracksTest, NamesFileLineAndCauseOfABrokenRecord) {
  EXPECT_THAT(Error("1 0 0 0 1 0"), HasSubstr("second end point: is missing"));
  EXPECT_THAT(Error("x 0 0 0 1 0 0 1 1 0"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(Error("-1 0 0 0 1 0 0 1 1 0"), HasSubstr("line id: is negative"));
  EXPECT_THAT(Error("1 nan 0 0 1 0 0 1 1 0"), HasSubstr("first end point: is not finite"));
  EXPECT_THAT(Error("1 0 0 0 inf 0 0 1 1 0"), HasSubstr("second end point: is not finite"));
  EXPECT_THAT(Error("1 0 0 0 0 0 0 1 1 0"), HasSubstr("equals the first"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 0 0"), HasSubstr("number of images: 0 is outside"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 2000000000 1"), HasSubstr("number of images: 2000000000"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 2 5 5 0"), HasSubstr("image id: 5 stands twice"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 1 1 -1"), HasSubstr("number of descriptors: -1"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 1 1 1"), HasSubstr("has 0 hex digits, but binary2 has 4"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 1 1 1 12345"), HasSubstr("has 5 hex digits"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 1 1 1 12g4"), HasSubstr("not hex"));
  EXPECT_THAT(Error("1 0 0 0 1 0 0 1 1 0 9"), HasSubstr("goes on after"));
}

TEST_F(LineTracksTest, RefusesALineIdThatStandsTwice) {
  const Result<LineTracks> tracks =
      Read("maploc-lines 1 none\n1 0 0 0 1 0 0 1 1 0\n1 0 0 0 0 1 0 1 1 0\n");
  ASSERT_FALSE(tracks.ok());
  EXPECT_THAT(tracks.status().message(), HasSubstr(":3: line id: 1 stands twice"));
}

TEST_F(LineTracksTest, RefusesDescriptorsInAFileOfKindNone) {
  const Result<LineTracks> tracks = Read("maploc-lines 1 none\n1 0 0 0 1 0 0 1 1 1 00\n");
  ASSERT_FALSE(tracks.ok());
  EXPECT_THAT(tracks.status().message(), HasSubstr("kind none"));
}

TEST_F(LineTracksTest, RefusesOtherFilesByTheirFirstLine) {
  EXPECT_THAT(Read("3 1 2 3\n").status().message(), HasSubstr(":1: header: is not"));
  EXPECT_THAT(Read("maploc-lines 2 lbd\n").status().message(), HasSubstr(":1: header: is not"));
  EXPECT_THAT(Read("maploc-lines 1 freak\n").status().message(), HasSubstr(":1: "));
  EXPECT_THAT(Read("").status().message(), HasSubstr("is empty"));
  EXPECT_EQ(ReadLineTracks(path_ + ".absent").status().code(), StatusCode::kNotFound);
}

// What other programs write, as they write it.
TEST_F(LineTracksTest, NamesTheProgramOfAnotherFormatAndSaysWhatToDo) {
  const auto expect = [&](const std::string& text, const std::string& name) {
    const std::string message = Read(text).status().message();
    EXPECT_THAT(message, HasSubstr(path_ + ": looks like " + name));
    EXPECT_THAT(message, HasSubstr("--images with --lines auto"));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  expect("1\n0 2 2\n0.1 0.2 0.3\n1.1 0.2 0.3\n4 5 \n17 3 \n", "LIMAP's line tracks (alltracks");
  expect("0.1 0.2 0.3 1.1 0.2 0.3 \n3 3\nimage_id_list 0 1 2 \n", "one of LIMAP's line tracks");
  expect("v 0.1 0.2 0.3\nv 1.1 0.2 0.3\nl 1 2\n", "a Wavefront OBJ of LIMAP or Line3D++");
  expect("1 4.7 -1.3 1.9 4.8 -1.3 1.9 2 19 273 906.9 594.2 1019.5 583.4 17 313 963.1 477 9 4 \n",
         "Line3D++'s text result");
  expect("2 4 -1 1 4 -1 2 5 -1 1 5 -1 2 1 19 273 906.9 594.2 1019.5 583.4\r\n",
         "Line3D++'s text result");
  expect("solid lineModel\nfacet normal 1 0 0\n", "an STL of Line3D++");
  expect(std::string("\x93NUMPY\x01\0v\0", 10), "a NumPy array");
  expect(std::string("\x16\0\0\0\0\0\0\0serialization::archive\x0a\0", 32),
         "Line3D++'s binary result");
  // Six times this count, modulo 2^64, is the 2 numbers that follow it.
  EXPECT_THAT(Read("2 4 -1 1 4 -1 2 5 -1 1 5 -1 2 3074457345618258603 1 2\n").status().message(),
              HasSubstr(":1: header: is not"));
  folder_.Write("track_0.txt", "");
  EXPECT_THAT(ReadLineTracks(folder_.path()).status().message(),
              HasSubstr("looks like LIMAP's folder of line tracks (finaltracks)"));
}

}  // namespace
}  // namespace maploc
