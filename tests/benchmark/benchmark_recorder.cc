// What the recorder costs a query: the thread that answers it, and the one that writes.
#include <benchmark/benchmark.h>

#include "maploc/recording/v1/recording.pb.h"
#include "server/recorder/query_recorder.h"
#include "server/recorder/recording_ring.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

// A photo's query: so many SIFT points.
recording::v1::RecordedQuery QueryOf(int points) {
  recording::v1::RecordedQuery query;
  v1::Features* const features = query.mutable_request()->add_views()->mutable_points();
  for (int i = 0; i < 2 * points; ++i) features->add_coordinates_pixels(static_cast<float>(i));
  features->mutable_descriptors()->assign(128 * static_cast<std::size_t>(points), 'd');
  query.mutable_answer()->set_outcome(v1::OUTCOME_LOCALIZED);
  query.mutable_answer()->set_confidence(1.0);
  query.set_map("campus");
  return query;
}

// The thread that answers. state.range(0): each Nth is recorded. The copy stands for the request
// that the call has anyhow, and is not timed.
void OfferQuery(benchmark::State& state) {
  const testing::TemporaryFolder folder;
  RecorderOptions options;
  options.folder = folder.File("recording");
  options.max_bytes = kMinRecorderBytes;
  options.every = static_cast<int>(state.range(0));
  const auto recorder = QueryRecorder::Start(options).value();
  const recording::v1::RecordedQuery query = QueryOf(static_cast<int>(state.range(1)));
  for (auto _ : state) {
    state.PauseTiming();
    recording::v1::RecordedQuery copy = query;
    state.ResumeTiming();
    recorder->Offer(std::move(copy));
  }
  state.counters["lost"] = static_cast<double>(recorder->state().lost);
}
BENCHMARK(OfferQuery)->Args({1000000000, 5000})->Args({1, 5000})->Args({1, 500});

// The recorder's thread: bytes, checksum, file.
void WriteQuery(benchmark::State& state) {
  const testing::TemporaryFolder folder;
  RecordingRing ring = RecordingRing::Open(folder.File("recording"), kMinRecorderBytes).value();
  const recording::v1::RecordedQuery query = QueryOf(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    if (!ring.Append(query.SerializeAsString()).ok()) state.SkipWithError("not written");
  }
}
BENCHMARK(WriteQuery)->Arg(5000)->Arg(500);

}  // namespace
}  // namespace maploc
