// The files of a recording: bounded, private, and whole whatever the disk does.
#include "server/recorder/recording_ring.h"

#include <csignal>

#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "proto/recording/recording.h"
#include "proto/recording/recording_file.h"
#include "tests/support/failing_disk.h"
#include "tests/support/files.h"
#include "tests/unit/proto/recording/recorded_bytes.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

class RecordingRingTest : public ::testing::Test {
 protected:
  std::string Folder() const { return folder_.File("recording"); }
  RecordingRing Open() const {
    Result<RecordingRing> ring = RecordingRing::Open(Folder(), kMinRecorderBytes);
    EXPECT_TRUE(ring.ok()) << ring.status().ToString();
    return *std::move(ring);
  }
  // A record that is found again by its time.
  static std::string Record(std::int64_t time, int points = 3) {
    auto record = ValidRecord();
    record.set_answered_unix_nanos(time);
    v1::Features* features = record.mutable_request()->mutable_views(0)->mutable_points();
    for (int i = 3; i < points; ++i) {
      features->add_coordinates_pixels(static_cast<float>(i % 600));
      features->add_coordinates_pixels(5.0f);
    }
    features->mutable_descriptors()->resize(static_cast<std::size_t>(points) * 32, 'x');
    return record.SerializeAsString();
  }
  std::vector<std::int64_t> Times() const {
    std::vector<std::int64_t> times;
    const Recording recording = Recording::Open(Folder()).value();
    const auto positions = recording.FindLast({}, 100000);
    EXPECT_TRUE(positions.ok()) << positions.status().ToString();
    if (!positions.ok()) return times;
    for (const RecordPosition& position : *positions) {
      times.push_back(recording.Read(position).value().answered_unix_ns);
    }
    return times;
  }
  std::int64_t BytesOnDisk() const {
    std::int64_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(Folder())) {
      bytes += static_cast<std::int64_t>(entry.file_size());
    }
    return bytes;
  }
  static mode_t ModeOf(const std::string& path) {
    struct stat state {};
    EXPECT_EQ(stat(path.c_str(), &state), 0);
    return state.st_mode & 0777;
  }

  const TemporaryFolder folder_;
};

TEST_F(RecordingRingTest, TheOldestGo) {
  RecordingRing ring = Open();
  const int count = 120;  // of 0.8 MB
  for (int i = 1; i <= count; ++i) {
    ASSERT_TRUE(ring.Append(Record(i, 20000)).ok());
    ASSERT_LE(ring.bytes(), kMinRecorderBytes);
  }
  EXPECT_EQ(ring.bytes(), BytesOnDisk());
  const std::vector<std::int64_t> times = Times();
  ASSERT_GT(times.size(), 60u);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(times[i], count - static_cast<std::int64_t>(times.size() - 1 - i));
  }
}

TEST_F(RecordingRingTest, OnlyItsOwnerMayRead) {
  const mode_t before = umask(0);
  RecordingRing ring = Open();
  ASSERT_TRUE(ring.Append(Record(1)).ok());
  umask(before);
  EXPECT_EQ(ModeOf(Folder()), 0700u);
  EXPECT_EQ(ModeOf(Folder() + "/" + RecordingName(1)), 0600u);
}

TEST_F(RecordingRingTest, ARestartGoesOnBehindATornRecord) {
  {
    RecordingRing ring = Open();
    ASSERT_TRUE(ring.Append(Record(1)).ok());
    ASSERT_TRUE(ring.Append(Record(2)).ok());
  }
  const std::string file = Folder() + "/" + RecordingName(1);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);
  RecordingRing ring = Open();
  ASSERT_TRUE(ring.Append(Record(3)).ok());
  EXPECT_THAT(Times(), ::testing::ElementsAre(1, 3));
}

TEST_F(RecordingRingTest, OneServerAFolder) {
  const RecordingRing ring = Open();
  const auto second = RecordingRing::Open(Folder(), kMinRecorderBytes);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.status().reason(), "RECORDER_IN_USE");
}

TEST_F(RecordingRingTest, AFolderThatCannotBeIsTold) {
  EXPECT_THAT(RecordingRing::Open(folder_.File("a/b"), kMinRecorderBytes).status().message(),
              HasSubstr("--recorder: " + folder_.File("a/b") + ": the folder " + folder_.File("a") +
                        " does not exist; make it"));
  folder_.Write("file", "x");
  EXPECT_EQ(RecordingRing::Open(folder_.File("file"), kMinRecorderBytes).status().reason(),
            "RECORDER_UNUSABLE");
}

// As on a full disk: a part of the record is written, then no more.
TEST_F(RecordingRingTest, OfARecordThatDoesNotFitNothingStays) {
  std::signal(SIGXFSZ, SIG_IGN);
  RecordingRing ring = Open();
  ASSERT_TRUE(ring.Append(Record(1)).ok());
  const std::int64_t before = ring.bytes();
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  rlimit tight = limit;
  tight.rlim_cur = static_cast<rlim_t>(before) + 100;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  const Status full = ring.Append(Record(2));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  EXPECT_EQ(full.reason(), "DISK_FULL");
  EXPECT_EQ(BytesOnDisk(), before);
  ASSERT_TRUE(ring.Append(Record(3)).ok());
  EXPECT_THAT(Times(), ::testing::ElementsAre(1, 3));
}

// The store's disk is not filled up; with more room it goes on.
TEST_F(RecordingRingTest, TheLastOfTheDiskIsLeftToOthers) {
  const SmallDisk disk(folder_.File("disk"));
  if (!disk.Missing().empty()) GTEST_SKIP() << disk.Missing();
  auto ring = RecordingRing::Open(disk.folder() + "/recording", kMinRecorderBytes);
  ASSERT_TRUE(ring.ok()) << ring.status().ToString();
  EXPECT_EQ(ring->Append(Record(1)).reason(), "DISK_FULL");
  EXPECT_TRUE(std::filesystem::is_empty(disk.folder() + "/recording"));
  ASSERT_EQ(mount("tmpfs", disk.folder().c_str(), "tmpfs", MS_REMOUNT, "size=300m"), 0);
  EXPECT_TRUE(ring->Append(Record(2)).ok());
}

TEST_F(RecordingRingTest, NamesThatAreTakenArePassedOver) {
  std::filesystem::create_directory(Folder());
  std::filesystem::create_directory(Folder() + "/" + RecordingName(1));
  std::filesystem::create_symlink("nowhere", Folder() + "/" + RecordingName(2));
  RecordingRing ring = Open();
  const Status status = ring.Append(Record(1));
  EXPECT_TRUE(status.ok()) << status.ToString();
  EXPECT_THAT(Times(), ::testing::ElementsAre(1));
  EXPECT_FALSE(std::filesystem::exists(Folder() + "/nowhere"));
}

TEST_F(RecordingRingTest, AFileThatWasCutIsLeftAlone) {
  RecordingRing ring = Open();
  ASSERT_TRUE(ring.Append(Record(1)).ok());
  std::filesystem::resize_file(Folder() + "/" + RecordingName(1), 0);
  ASSERT_TRUE(ring.Append(Record(2)).ok());
  EXPECT_THAT(Times(), ::testing::ElementsAre(2));
}

TEST_F(RecordingRingTest, WhatAnOperatorDeletesIsNotMissed) {
  RecordingRing ring = Open();
  ASSERT_TRUE(ring.Append(Record(1)).ok());
  std::filesystem::remove(Folder() + "/" + RecordingName(1));
  ASSERT_TRUE(ring.Append(Record(2)).ok());
  EXPECT_THAT(Times(), ::testing::ElementsAre(2));
  std::filesystem::remove_all(Folder());
  EXPECT_FALSE(ring.Append(Record(3)).ok());
  std::filesystem::create_directory(Folder());
  ASSERT_TRUE(ring.Append(Record(4)).ok());
  EXPECT_THAT(Times(), ::testing::ElementsAre(4));
}

}  // namespace
}  // namespace maploc::testing
