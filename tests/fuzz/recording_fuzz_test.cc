// Mutated recordings through their reader: each is read or refused with the file and the byte.
#include <gmock/gmock.h>
#include <google/protobuf/stubs/logging.h>

#include "proto/recording/recording_file.h"
#include "tests/fuzz/mutate.h"
#include "tests/support/files.h"
#include "tests/unit/proto/recording/recorded_bytes.h"

namespace maploc::testing {
namespace {

// A mutation that gets past the checksum, as a hostile writer's would.
std::string Hostile(Random& random, const std::string& record) {
  std::string bytes = record;
  for (std::uint32_t i = 0; i <= random.Below(4); ++i) Mutate(random, &bytes);
  return std::string(kRecordingMagic) + Framed(record) + Framed(bytes) + Framed(record);
}

Status ReadAll(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(RecordingFile file, RecordingFile::Open(path));
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(const std::optional<RecordedQuery> next, file.Next());
    if (!next) return Status::Ok();
    EXPECT_EQ(next->query.views.size(), 1u);
  }
}

TEST(RecordingFuzz, SurvivesAnything) {
  const google::protobuf::LogSilencer silence;
  Random random = TestRandom();
  const TemporaryFolder folder;
  const std::string record = ValidRecord().SerializeAsString();
  const std::string whole = RecordingBytes({ValidRecord(), ValidRecord(), ValidRecord()});
  const auto end = std::chrono::steady_clock::now() + FuzzTime();
  int read = 0;
  int refused = 0;
  while (std::chrono::steady_clock::now() < end) {
    const bool hostile = random.Below(2) == 0;
    folder.Write("file", hostile ? Hostile(random, record) : NextInput(random, whole));
    const Status status = ReadAll(folder.File("file"));
    status.ok() ? ++read : ++refused;
    if (status.ok()) continue;
    ASSERT_THAT(status.message(), ::testing::HasSubstr(folder.File("file") + ": byte "));
  }
  EXPECT_GT(read, 5);
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace maploc::testing
