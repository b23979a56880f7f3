// What is read of a recording, and what is refused.
#include "proto/recording/recording.h"

#include <limits>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "proto/recording/recording_file.h"
#include "tests/support/files.h"
#include "tests/unit/proto/recording/recorded_bytes.h"

namespace maploc::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RecordingTest : public ::testing::Test {
 protected:
  // All records of a file with these bytes, or what is wrong with it.
  Result<std::vector<RecordedQuery>> ReadAll(const std::string& bytes) const {
    folder_.Write("file", bytes);
    MAPLOC_ASSIGN_OR_RETURN(RecordingFile file, RecordingFile::Open(folder_.File("file")));
    std::vector<RecordedQuery> all;
    while (true) {
      MAPLOC_ASSIGN_OR_RETURN(std::optional<RecordedQuery> next, file.Next());
      if (!next) return all;
      all.push_back(*std::move(next));
    }
  }
  Status FaultOf(const std::string& bytes) const { return ReadAll(bytes).status(); }

  const TemporaryFolder folder_;
};

TEST_F(RecordingTest, TellsTheQueryAndWhatBecameOfIt) {
  const auto all = ReadAll(RecordingBytes(
      {ValidRecord(), RefusedRecord(StatusCode::kDeadlineExceeded, "DEADLINE_EXCEEDED")}));
  ASSERT_TRUE(all.ok()) << all.status().ToString();
  ASSERT_EQ(all->size(), 2u);
  const RecordedQuery& first = (*all)[0];
  EXPECT_EQ(first.robot, "rover-1");
  EXPECT_EQ(first.map, (MapKey{"yard", 3}));
  EXPECT_EQ(first.answered_unix_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(first.total_ms, 12.5);
  EXPECT_EQ(first.query.views[0].points.keypoints_px.size(), 3u);
  ASSERT_TRUE(first.answer.ok());
  EXPECT_EQ(first.answer->map_from_body->translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(OutcomeText(first.answer), "LOCALIZED");
  EXPECT_EQ(OutcomeText((*all)[1].answer), "DEADLINE_EXCEEDED");
}

TEST_F(RecordingTest, ARepeatedQueryCountsNowhere) {
  const auto all = ReadAll(RecordingBytes({ValidRecord()}));
  ASSERT_TRUE(all.ok());
  const Query repeat = all->front().ToRepeat();
  EXPECT_EQ(repeat.session, "");
  EXPECT_EQ(repeat.request_id, "");
  EXPECT_EQ(repeat.map, "yard");
  EXPECT_EQ(repeat.map_version, 0);
  EXPECT_EQ(repeat.requested_strategy, Strategy::k2P);
}

TEST_F(RecordingTest, AnEndThatAKilledServerHasTornIsSkipped) {
  const std::string whole = RecordingBytes({ValidRecord()});
  const std::string bytes = RecordingBytes({ValidRecord(), ValidRecord()});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto all = ReadAll(bytes.substr(0, size));
    ASSERT_TRUE(all.ok()) << size << ": " << all.status().ToString();
    ASSERT_EQ(all->size(), size < whole.size() ? 0u : 1u) << size;
  }
}

// The file's length was on the disk, its end was not.
TEST_F(RecordingTest, AnEndOfZerosIsSkipped) {
  const auto all = ReadAll(RecordingBytes({ValidRecord()}) + std::string(10000, '\0'));
  ASSERT_TRUE(all.ok()) << all.status().ToString();
  EXPECT_EQ(all->size(), 1u);
}

TEST_F(RecordingTest, ADamagedRecordIsRefusedWithFileAndByte) {
  const std::string one = RecordingBytes({ValidRecord()});
  std::string bytes = RecordingBytes({ValidRecord(), ValidRecord(), ValidRecord()});
  bytes[one.size() + 20] ^= 1;
  const Status fault = FaultOf(bytes);
  EXPECT_EQ(fault.code(), StatusCode::kDataLoss);
  EXPECT_THAT(fault.message(),
              HasSubstr(folder_.File("file") + ": byte " + std::to_string(one.size()) + ": "));
}

TEST_F(RecordingTest, ALengthIsNotBelieved) {
  for (const char byte : {'\xff', '\0'}) {
    const Status fault =
        FaultOf(std::string(kRecordingMagic) + std::string(4, byte) + "0123456789");
    EXPECT_EQ(fault.reason(), "DAMAGED_RECORDING");
    EXPECT_THAT(fault.message(), HasSubstr(": byte 8: "));
  }
}

TEST_F(RecordingTest, WhatTheWireRefusesIsRefusedHereToo) {
  auto broken = ValidRecord();
  broken.mutable_request()->mutable_views(0)->mutable_points()->set_coordinates_pixels(
      1, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(
      FaultOf(RecordingBytes({broken})).message(),
      AllOf(HasSubstr("byte 8"), HasSubstr("request: views[0].points.coordinates_pixels[1]")));
  broken = ValidRecord();
  broken.mutable_answer()->clear_map_from_body();
  EXPECT_THAT(FaultOf(RecordingBytes({broken})).message(), HasSubstr("answer: "));
  broken = ValidRecord();
  broken.clear_answer();
  EXPECT_THAT(FaultOf(RecordingBytes({broken})).message(), HasSubstr("answer: must be set"));
  broken = RefusedRecord(static_cast<StatusCode>(99), "NONE");
  EXPECT_THAT(FaultOf(RecordingBytes({broken})).message(), HasSubstr("refusal.code"));
  broken = ValidRecord();
  broken.set_robot("rover\n1");
  EXPECT_THAT(FaultOf(RecordingBytes({broken})).message(), HasSubstr("robot"));
  broken = ValidRecord();
  broken.set_total_ms(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(FaultOf(RecordingBytes({broken})).message(), HasSubstr("total_ms"));
}

TEST_F(RecordingTest, OtherFilesAreNone) {
  EXPECT_EQ(FaultOf("a picture, perhaps").reason(), "NOT_A_RECORDING");
  EXPECT_EQ(FaultOf("maplocR2").reason(), "RECORDING_TOO_NEW");
  EXPECT_EQ(Recording::Open(folder_.File("none")).status().reason(), "FILE_NOT_FOUND");
  EXPECT_EQ(Recording::Open(folder_.path()).status().reason(), "FILE_NOT_FOUND");
  ASSERT_EQ(mkfifo(folder_.File("pipe").c_str(), 0600), 0);  // nobody ever writes to it
  EXPECT_EQ(RecordingFile::Open(folder_.File("pipe")).status().reason(), "NOT_A_RECORDING");
}

TEST_F(RecordingTest, TheLastOfAFolderAreFound) {
  const auto record = [](const std::string& robot, std::int64_t time) {
    auto made = ValidRecord();
    made.set_robot(robot);
    made.set_answered_unix_nanos(time);
    return made;
  };
  // In the order of their numbers, not of their names' making.
  folder_.Write(RecordingName(10), RecordingBytes({record("a", 3), record("b", 4)}));
  folder_.Write(RecordingName(9), RecordingBytes({record("a", 1), record("a", 2)}));
  folder_.Write("notes.txt", "not one of them");
  const auto recording = Recording::Open(folder_.path());
  ASSERT_TRUE(recording.ok()) << recording.status().ToString();
  const auto times = [&](const RecordingFilter& filter, std::size_t most) {
    std::vector<std::int64_t> found;
    const auto positions = recording->FindLast(filter, most);
    EXPECT_TRUE(positions.ok()) << positions.status().ToString();
    if (!positions.ok()) return found;
    for (const RecordPosition& position : *positions) {
      found.push_back(recording->Read(position).value().answered_unix_ns);
    }
    return found;
  };
  EXPECT_THAT(times({}, 3), ::testing::ElementsAre(2, 3, 4));
  EXPECT_THAT(times({.robot = "a"}, 2), ::testing::ElementsAre(2, 3));
  EXPECT_THAT(times({.map = "yard", .outcome = "LOCALIZED"}, 99),
              ::testing::ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(recording->FindLast({.map = "another"}, 3).status().reason(), "NOTHING_RECORDED");
  EXPECT_EQ(recording->FindLast({.outcome = "NO_CONSENSUS"}, 3).status().reason(),
            "NOTHING_RECORDED");
}

}  // namespace
}  // namespace maploc::testing
