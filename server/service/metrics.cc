#include "server/service/metrics.h"

#include <cmath>
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

// Up to half of what a call may take (kMaxCallTime).
const Buckets kSeconds = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30};
const Buckets kRatios = {0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
// Closer towards 1, because poses are LOCALIZED from 0.99 on (--min-confidence).
const Buckets kConfidences = {0.1, 0.5, 0.9, 0.99, 0.999, 0.9999};
// From a good IMU at rest (0.1 degrees) to one that is mounted wrong.
const Buckets kRadians = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1};
const Buckets kShares = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2};

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

prometheus::Counter& OneCounter(prometheus::Registry& registry, const char* name,
                                const char* help) {
  return Counters(registry, name, help).Add({});
}

// To a total that somebody else has counted. REQUIRES: nobody else raises it at the same time.
void RaiseTo(prometheus::Counter& counter, std::size_t total) {
  // A negative increment is ignored by prometheus-cpp. So of two scrapes at the same time the one
  // with the older total changes nothing.
  counter.Increment(static_cast<double>(total) - counter.Value());
}

// The gauges and counters that are read when somebody scrapes.
struct StateMetrics {
  explicit StateMetrics(prometheus::Registry& used) : registry(used) {}

  void Set(const ServerState& state);
  void SetCache(const SegmentCacheState& cache);
  void SetRecorder(const RecorderState& state);

  prometheus::Registry& registry;
  prometheus::Gauge& healthy = OneGauge(registry, "maploc_healthy",
                                        "1 while health is SERVING; the log has the reason for 0");
  prometheus::Gauge& open_sessions =
      OneGauge(registry, "maploc_open_sessions", "Robots' sessions that go on");
  prometheus::Gauge& unsaved = OneGauge(registry, "maploc_unsaved_observations",
                                        "Answered queries that are not in the store yet");
  prometheus::Gauge& store_lag = OneGauge(registry, "maploc_store_lag_seconds",
                                          "Age of the oldest one that is not in the store yet");
  prometheus::Counter& lost =
      OneCounter(registry, "maploc_lost_observations_total",
                 "Answered queries that came too late for their session's statistics");
  prometheus::Gauge& localizations =
      OneGauge(registry, "maploc_localizations", "Localizations that run or wait");
  prometheus::Gauge& localizations_limit =
      OneGauge(registry, "maploc_localizations_limit",
               "As many localizations may run or wait; more are refused (QUEUE_FULL)");
  prometheus::Gauge& cache_bytes =
      OneGauge(registry, "maploc_segment_cache_bytes", "Memory of the segments that are loaded");
  prometheus::Gauge& cache_limit = OneGauge(registry, "maploc_segment_cache_limit_bytes",
                                            "Beyond it unused segments leave the memory");
  prometheus::Counter& cache_hits = OneCounter(registry, "maploc_segment_cache_hits_total",
                                               "Segments that were in memory when needed");
  prometheus::Counter& cache_loads = OneCounter(registry, "maploc_segment_cache_loads_total",
                                                "Segments that were read from the store");
  prometheus::Counter& cache_evictions = OneCounter(
      registry, "maploc_segment_cache_evictions_total", "Segments that left the memory for others");
  prometheus::Counter& lost_log_lines =
      OneCounter(registry, "maploc_lost_log_lines_total",
                 "Lines about requests that came faster than the log could be written");
  prometheus::Gauge& recorder_bytes =
      OneGauge(registry, "maploc_recorder_bytes", "Recorded queries on disk (--recorder)");
  prometheus::Counter& recorded =
      OneCounter(registry, "maploc_recorder_queries_total", "Queries that were recorded");
  prometheus::Counter& lost_queries =
      OneCounter(registry, "maploc_recorder_lost_queries_total",
                 "Queries that were not recorded because the disk was too slow, full or failing");
  prometheus::Family<prometheus::Gauge>& certificate_end =
      prometheus::BuildGauge()
          .Name("maploc_tls_certificate_end_timestamp_seconds")
          .Help("Until when the certificate in use is valid, Unix time; no sample without TLS")
          .Register(registry);
};

void StateMetrics::Set(const ServerState& state) {
  healthy.Set(state.healthy ? 1 : 0);
  open_sessions.Set(static_cast<double>(state.open_sessions));
  unsaved.Set(static_cast<double>(state.unsaved_observations));
  store_lag.Set(state.store_lag_s);
  RaiseTo(lost, state.lost_observations);
  localizations.Set(static_cast<double>(state.localizations));
  localizations_limit.Set(static_cast<double>(state.localizations_limit));
  SetCache(state.cache);
  SetRecorder(state.recorder);
  RaiseTo(lost_log_lines, state.lost_log_lines);
  if (state.certificate_end_unix_s) {
    certificate_end.Add({}).Set(static_cast<double>(*state.certificate_end_unix_s));
  }
}

void StateMetrics::SetCache(const SegmentCacheState& cache) {
  cache_bytes.Set(static_cast<double>(cache.bytes));
  cache_limit.Set(static_cast<double>(cache.budget_bytes));
  RaiseTo(cache_hits, cache.hits);
  RaiseTo(cache_loads, cache.loads);
  RaiseTo(cache_evictions, cache.evictions);
}

void StateMetrics::SetRecorder(const RecorderState& state) {
  recorder_bytes.Set(static_cast<double>(state.bytes));
  RaiseTo(recorded, state.recorded);
  RaiseTo(lost_queries, state.lost);
}

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

  void ObserveStages(const StageTimes& times) {
    const auto stage = [this](const char* name, double milliseconds) {
      stage_seconds.Add({{"stage", name}}, kSeconds).Observe(milliseconds / 1000.0);
    };
    stage("convert", times.convert_ms);
    stage("retrieval", times.retrieval_ms);
    stage("matching", times.matching_ms);
    stage("ransac", times.ransac_ms);
    stage("refinement", times.refinement_ms);
  }

  void ObserveEvidence(const Evidence& evidence, const Labels& map) {
    confidence.Add(map, kConfidences).Observe(evidence.confidence);
    // 0 stands for a query whose gravity was not compared.
    if (evidence.gravity_disagreement_rad > 0) {
      gravity_disagreement.Add(map, kRadians).Observe(evidence.gravity_disagreement_rad);
    }
    if (evidence.focal_scale) {
      focal_deviation.Add(map, kShares).Observe(std::abs(evidence.focal_scale->scale - 1.0));
    }
  }

  void ObserveInliers(const Evidence& evidence, const Labels& map) {
    const auto observe = [&map](prometheus::Family<prometheus::Histogram>& ratios, double inliers,
                                double matches) {
      if (matches > 0) ratios.Add(map, kRatios).Observe(inliers / matches);
    };
    const FeatureCounts& usable = evidence.usable_lines;
    const FeatureCounts& vertical = evidence.vertical_lines;
    observe(point_inlier_ratio, evidence.points.inliers, evidence.points.matches);
    observe(line_inlier_ratio, usable.inliers + vertical.inliers,
            usable.matches + vertical.matches);
    if (evidence.gravity_rejected) gravity_rejected.Add(map).Increment();
  }

  prometheus::Registry registry;
  prometheus::Family<prometheus::Counter>& calls =
      Counters(registry, "maploc_calls_total", "Calls that were answered or refused");
  prometheus::Family<prometheus::Histogram>& call_seconds = Histograms(
      registry, "maploc_call_seconds", "From a call's arrival to its answer, refused ones apart");
  prometheus::Family<prometheus::Histogram>& wait_seconds = Histograms(
      registry, "maploc_wait_seconds", "How long calls that ran had waited for a thread");
  prometheus::Family<prometheus::Counter>& refused =
      Counters(registry, "maploc_refused_calls_total",
               "Calls that were not answered, by the error's reason");
  prometheus::Family<prometheus::Counter>& answers =
      Counters(registry, "maploc_answers_total",
               "Queries that were worked on, by what became of "
               "them and the strategy that was sampled with");
  prometheus::Family<prometheus::Histogram>& stage_seconds =
      Histograms(registry, "maploc_stage_seconds", "Time of a query's stages");
  prometheus::Family<prometheus::Histogram>& point_inlier_ratio =
      Histograms(registry, "maploc_point_inlier_ratio", "Inliers of the point matches, LOCALIZED");
  prometheus::Family<prometheus::Histogram>& line_inlier_ratio =
      Histograms(registry, "maploc_line_inlier_ratio", "Inliers of the line matches, LOCALIZED");
  prometheus::Family<prometheus::Histogram>& confidence =
      Histograms(registry, "maploc_confidence", "Confidence of the poses that were found");
  prometheus::Family<prometheus::Counter>& gravity_rejected =
      Counters(registry, "maploc_gravity_rejected_total",
               "LOCALIZED answers whose matches contradict the gravity that was sent");
  prometheus::Family<prometheus::Histogram>& gravity_disagreement =
      Histograms(registry, "maploc_gravity_disagreement_radians",
                 "Between the gravity that was sent and that of the matches alone");
  prometheus::Family<prometheus::Histogram>& focal_deviation =
      Histograms(registry, "maploc_focal_length_deviation",
                 "How far the focal length that was sent is from that of the matches, as a share");
  StateMetrics state{registry};

  std::mutex state_mutex;  // guards `state`
  Values maps{kMaxMapLabels};
  Values reasons{kMaxReasonLabels};
};

ServerMetrics::ServerMetrics() : impl_(std::make_unique<Impl>()) {}

ServerMetrics::~ServerMetrics() = default;

void ServerMetrics::CountCall(const std::string& method, const Status& status, double seconds) {
  const std::string code(StatusCodeName(status.code()));
  impl_->calls.Add({{"method", method}, {"code", code}}).Increment();
  if (!status.ok()) {
    impl_->refused
        .Add({{"method", method}, {"code", code}, {"reason", impl_->reasons.Of(status.reason())}})
        .Increment();
  }
  // Refusals take no time. With them a server that is full would look fast.
  if (status.code() == StatusCode::kResourceExhausted ||
      status.code() == StatusCode::kUnavailable) {
    return;
  }
  impl_->call_seconds.Add({{"method", method}}, kSeconds).Observe(seconds);
}

void ServerMetrics::ObserveWait(const std::string& method, double seconds) {
  impl_->wait_seconds.Add({{"method", method}}, kSeconds).Observe(seconds);
}

void ServerMetrics::CountAnswer(const Localization& answer) {
  const Labels map = {{"map", impl_->maps.Of(answer.map.name)}};
  Labels labels = map;
  labels["outcome"] = OutcomeName(answer.outcome);
  labels["strategy"] = StrategyName(answer.evidence.strategy);
  impl_->answers.Add(labels).Increment();
  impl_->ObserveStages(answer.times);
  // Nothing was matched, so the evidence holds zeros that nobody measured.
  if (answer.outcome == Outcome::kOutOfMap) return;
  impl_->ObserveEvidence(answer.evidence, map);
  // Without a pose no match is an inlier, which says nothing about the map.
  if (answer.outcome == Outcome::kLocalized) impl_->ObserveInliers(answer.evidence, map);
}

std::string ServerMetrics::Text(const ServerState& state) {
  {
    const std::lock_guard lock(impl_->state_mutex);
    impl_->state.Set(state);
  }
  return prometheus::TextSerializer().Serialize(impl_->registry.Collect());
}

}  // namespace maploc
