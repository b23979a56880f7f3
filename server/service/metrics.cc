#include "server/service/metrics.h"

#include <mutex>
#include <set>

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

namespace maploc {
namespace {

using prometheus::Labels;
using Buckets = prometheus::Histogram::BucketBoundaries;

const Buckets kSeconds = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30};
const Buckets kRatios = {0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
const Buckets kConfidences = {0.1, 0.5, 0.9, 0.99, 0.999, 0.9999};

prometheus::Family<prometheus::Counter>& Counters(prometheus::Registry& registry, const char* name,
                                                  const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

prometheus::Family<prometheus::Histogram>& Histograms(prometheus::Registry& registry,
                                                      const char* name, const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

prometheus::Gauge& OneGauge(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

// Values of a label: the first `most` that come. Thread-safe.
class Values {
 public:
  explicit Values(std::size_t most) : most_(most) {}

  std::string Of(const std::string& value) {
    const std::lock_guard lock(mutex_);
    if (known_.contains(value)) return value;
    if (known_.size() >= most_) return kOther;
    return *known_.insert(value).first;
  }

 private:
  const std::size_t most_;
  std::mutex mutex_;
  std::set<std::string> known_;  // guarded by mutex_
};

}  // namespace

struct ServerMetrics::Impl {
  Impl() {
    prometheus::BuildGauge()
        .Name("maploc_build_info")
        .Help("1; the label is the server's version")
        .Register(registry)
        .Add({{"version", MAPLOC_VERSION}})
        .Set(1);
  }

  prometheus::Registry registry;
  prometheus::Family<prometheus::Counter>& calls =
      Counters(registry, "maploc_calls_total", "Calls that were answered or refused");
  prometheus::Family<prometheus::Counter>& refused =
      Counters(registry, "maploc_refused_calls_total",
               "Calls that were not answered, by the error's reason");
  prometheus::Family<prometheus::Histogram>& call_seconds = Histograms(
      registry, "maploc_call_seconds", "From a call's arrival to its answer, refused ones apart");
  prometheus::Family<prometheus::Counter>& answers =
      Counters(registry, "maploc_answers_total",
               "Queries that were worked on, by what became of "
               "them and the strategy that was sampled with");
  prometheus::Family<prometheus::Histogram>& stage_seconds =
      Histograms(registry, "maploc_stage_seconds", "Time of a query's stages");
  prometheus::Family<prometheus::Histogram>& inlier_ratio =
      Histograms(registry, "maploc_point_inlier_ratio", "Inliers of the point matches, LOCALIZED");
  prometheus::Family<prometheus::Histogram>& confidence =
      Histograms(registry, "maploc_confidence", "Confidence of the poses that were found");
  prometheus::Family<prometheus::Counter>& gravity_rejected =
      Counters(registry, "maploc_gravity_rejected_total",
               "LOCALIZED answers whose matches contradict the gravity that was sent");
  prometheus::Gauge& healthy = OneGauge(registry, "maploc_healthy",
                                        "1 while health is SERVING; the log has the reason for 0");
  prometheus::Gauge& open_sessions =
      OneGauge(registry, "maploc_open_sessions", "Robots' sessions that go on");
  prometheus::Gauge& unsaved = OneGauge(registry, "maploc_unsaved_observations",
                                        "Answered queries that are not in the store yet");
  prometheus::Gauge& localizations =
      OneGauge(registry, "maploc_localizations", "Localizations that run or wait");

  Values maps{kMaxMapLabels};
  Values reasons{kMaxReasonLabels};
};

ServerMetrics::ServerMetrics() : impl_(std::make_unique<Impl>()) {}

ServerMetrics::~ServerMetrics() = default;

void ServerMetrics::CountCall(const std::string& method, const Status& status, double seconds) {
  const StatusCode code = status.code();
  const std::string code_name(StatusCodeName(code));
  impl_->calls.Add({{"method", method}, {"code", code_name}}).Increment();
  if (!status.ok()) {
    impl_->refused.Add({{"code", code_name}, {"reason", impl_->reasons.Of(status.reason())}})
        .Increment();
  }
  if (code == StatusCode::kResourceExhausted || code == StatusCode::kUnavailable) return;
  impl_->call_seconds.Add({{"method", method}}, kSeconds).Observe(seconds);
}

void ServerMetrics::CountAnswer(const Localization& answer) {
  const Labels map = {{"map", impl_->maps.Of(answer.map.name)}};
  Labels labels = map;
  labels["outcome"] = OutcomeName(answer.outcome);
  labels["strategy"] = StrategyName(answer.evidence.strategy);
  impl_->answers.Add(labels).Increment();
  const auto stage = [this](const char* name, double milliseconds) {
    impl_->stage_seconds.Add({{"stage", name}}, kSeconds).Observe(milliseconds / 1000.0);
  };
  stage("convert", answer.times.convert_ms);
  stage("retrieval", answer.times.retrieval_ms);
  stage("matching", answer.times.matching_ms);
  stage("ransac", answer.times.ransac_ms);
  stage("refinement", answer.times.refinement_ms);
  if (answer.outcome == Outcome::kOutOfMap) return;
  impl_->confidence.Add(map, kConfidences).Observe(answer.evidence.confidence);
  if (answer.outcome != Outcome::kLocalized) return;
  const FeatureCounts& points = answer.evidence.points;
  if (points.matches > 0) {
    impl_->inlier_ratio.Add(map, kRatios)
        .Observe(static_cast<double>(points.inliers) / points.matches);
  }
  if (answer.evidence.gravity_rejected) impl_->gravity_rejected.Add(map).Increment();
}

std::string ServerMetrics::Text(const ServerState& state) {
  impl_->healthy.Set(state.healthy ? 1 : 0);
  impl_->open_sessions.Set(static_cast<double>(state.open_sessions));
  impl_->unsaved.Set(static_cast<double>(state.unsaved_observations));
  impl_->localizations.Set(static_cast<double>(state.localizations));
  return prometheus::TextSerializer().Serialize(impl_->registry.Collect());
}

}  // namespace maploc
