// What the log costs a request: the thread that answers, not the one that writes.
#include <benchmark/benchmark.h>
#include <spdlog/sinks/basic_file_sink.h>

#include "server/service/request_log.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

// state.range(0): each Nth request has a line. The file is a real one.
void LogRequest(benchmark::State& state) {
  const testing::TemporaryFolder folder;
  RequestLogOptions options;
  options.json = true;
  options.every = static_cast<int>(state.range(0));
  RequestLog log(options, std::make_shared<spdlog::sinks::basic_file_sink_mt>(folder.File("log")));
  const Status ok;
  RequestFacts facts;
  facts.request_id = "photo 1234";
  facts.robot = "rover-17";
  facts.map = "campus";
  facts.version = 3;
  facts.session = "8d0c2f9a51b34e7796c1d2e3f4a5b6c7";
  facts.outcome = Outcome::kLocalized;
  const std::string traceparent = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
  for (auto _ : state) log.Write({"Localize", ok, traceparent, facts, 0.1, 12.5});
  state.counters["lost"] = static_cast<double>(log.lost_lines());
}
BENCHMARK(LogRequest)->Arg(0)->Arg(100)->Arg(1);

}  // namespace
}  // namespace maploc
