// Which queries are recorded, and that nobody waits for it.
#include "server/recorder/query_recorder.h"

#include <gmock/gmock.h>

#include "proto/recording/recording.h"
#include "server/recorder/recording_ring.h"
#include "tests/support/files.h"
#include "tests/support/wait_for.h"
#include "tests/unit/proto/recording/recorded_bytes.h"

namespace maploc::testing {
namespace {

class QueryRecorderTest : public ::testing::Test {
 protected:
  explicit QueryRecorderTest() {
    options_.folder = folder_.File("recording");
    options_.every = 10;
    recorder_ = QueryRecorder::Start(options_).value();
  }
  void Offer(recording::v1::RecordedQuery query, int times = 1) {
    for (int i = 0; i < times; ++i) recorder_->Offer(recording::v1::RecordedQuery(query));
  }
  // Ends the recorder, which writes what waits.
  std::vector<RecordedQuery> Recorded() {
    recorder_.reset();
    std::vector<RecordedQuery> all;
    const auto recording = Recording::Open(options_.folder);
    if (!recording.ok()) return all;
    const auto positions = recording->FindLast({}, 1000);
    if (!positions.ok()) return all;
    for (const RecordPosition& position : *positions) {
      all.push_back(recording->Read(position).value());
    }
    return all;
  }

  const TemporaryFolder folder_;
  RecorderOptions options_;
  std::unique_ptr<QueryRecorder> recorder_;
};

TEST_F(QueryRecorderTest, OfThoseWithoutDoubtEachNth) {
  Offer(ValidRecord(), 30);
  const auto all = Recorded();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].stands_for, 10);
}

TEST_F(QueryRecorderTest, AllThatAreRefusedOrDoubtful) {
  Offer(ValidRecord());  // each tenth: the first
  Localization doubtful = LocalizedAnswer();
  doubtful.evidence.confidence = 0.995;
  Offer(ValidRecord(doubtful), 2);
  doubtful.evidence.confidence = 1.0;
  doubtful.evidence.gravity_rejected = true;
  Offer(ValidRecord(doubtful), 2);
  Localization none;
  none.outcome = Outcome::kTooFewMatches;
  Offer(ValidRecord(none), 2);
  Offer(RefusedRecord(StatusCode::kFailedPrecondition, "DESCRIPTOR_KIND_MISMATCH"), 2);
  const auto all = Recorded();
  ASSERT_EQ(all.size(), 9u);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_EQ(all[i].stands_for, 1);
}

// Who may not ask must not push out what others asked.
TEST_F(QueryRecorderTest, NothingOfWhomTheServerTurnsAway) {
  Offer(RefusedRecord(StatusCode::kPermissionDenied, "MAP_FORBIDDEN"));
  Offer(RefusedRecord(StatusCode::kInvalidArgument, "OUT_OF_RANGE"));
  Offer(RefusedRecord(StatusCode::kUnavailable, "STORE_REPLACED"));
  Offer(RefusedRecord(StatusCode::kFailedPrecondition, "SESSION_CLOSED"));
  Offer(RefusedRecord(StatusCode::kFailedPrecondition, "MAP_VERSION_MISMATCH"));
  auto nowhere = RefusedRecord(StatusCode::kFailedPrecondition, "DESCRIPTOR_KIND_MISMATCH");
  nowhere.clear_map();
  Offer(nowhere);
  EXPECT_EQ(Recorded().size(), 0u);
}

TEST_F(QueryRecorderTest, AFailingDiskIsCountedAndOvercome) {
  std::filesystem::remove_all(options_.folder);
  folder_.Write("recording", "no folder");
  Localization none;
  none.outcome = Outcome::kTooFewMatches;
  Offer(ValidRecord(none));
  ASSERT_TRUE(WaitFor([&] { return recorder_->state().lost == 1; }));
  std::filesystem::remove(options_.folder);
  std::filesystem::create_directory(options_.folder);
  ASSERT_TRUE(WaitFor([&] {
    Offer(ValidRecord(none));
    return recorder_->state().recorded > 0;
  }));
  EXPECT_GE(Recorded().size(), 1u);
}

}  // namespace
}  // namespace maploc::testing
