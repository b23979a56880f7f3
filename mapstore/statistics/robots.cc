#include "mapstore/statistics/robots.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "mapstore/base/median.h"
#include "mapstore/statistics/references.h"

namespace maploc {
namespace {

// Probability that a fleet without a fault has any robot (or, separately, any session) flagged:
// shared out among all tests made (Bonferroni).
constexpr double kFalseAlarm = 0.01;
// A session says something about a segment from this many queries on (localized ones, for ratios).
constexpr std::int64_t kMinQueries = 3;
// Sessions of other robots that a session is compared with, in each segment: the nearest in time.
constexpr std::int64_t kMaxReferences = 10;
// Smaller differences are ignored, however certain.
constexpr double kMinGravityRad = 0.0175;  // 1 degree
constexpr double kMinRatio = 0.1;
constexpr double kMinSuccess = 0.2;

constexpr double kFloorOfConcern = 0.25;

double Ratio(double part, double whole) { return part / whole; }

// What one session says about a metric in one segment; nullopt: too little.
std::optional<double> GravityOf(std::span<const Observation* const> seen, std::int64_t least) {
  std::vector<double> disagreements;
  for (const Observation* o : seen) {
    // Without a pose there is none, and it is zero.
    if (o->evidence.gravity_disagreement_rad > 0.0) {
      disagreements.push_back(o->evidence.gravity_disagreement_rad);
    }
  }
  if (static_cast<std::int64_t>(disagreements.size()) < least) return std::nullopt;
  return Median(std::move(disagreements));
}

std::optional<double> InlierRatioOf(std::span<const Observation* const> seen, std::int64_t least,
                                    bool points) {
  std::int64_t localized = 0;
  double matches = 0.0;
  double inliers = 0.0;
  for (const Observation* o : seen) {
    if (o->outcome != Outcome::kLocalized) continue;
    ++localized;
    const Evidence& e = o->evidence;
    matches += points ? e.points.matches : e.usable_lines.matches + e.vertical_lines.matches;
    inliers += points ? e.points.inliers : e.usable_lines.inliers + e.vertical_lines.inliers;
  }
  if (localized < least || matches <= 0.0) return std::nullopt;
  return Ratio(inliers, matches);
}

std::optional<double> SuccessOf(std::span<const Observation* const> seen, std::int64_t least) {
  if (static_cast<std::int64_t>(seen.size()) < least) return std::nullopt;
  const auto localized = std::count_if(seen.begin(), seen.end(), [](const Observation* o) {
    return o->outcome == Outcome::kLocalized;
  });
  return Ratio(static_cast<double>(localized), static_cast<double>(seen.size()));
}

std::optional<double> ValueOf(RobotMetric metric, std::span<const Observation* const> seen,
                              std::int64_t least) {
  switch (metric) {
    case RobotMetric::kGravity:
      return GravityOf(seen, least);
    case RobotMetric::kPoints:
      return InlierRatioOf(seen, least, true);
    case RobotMetric::kLines:
      return InlierRatioOf(seen, least, false);
    case RobotMetric::kSuccess:
      return SuccessOf(seen, least);
  }
  return std::nullopt;
}

double ConcernOf(RobotMetric metric) {
  switch (metric) {
    case RobotMetric::kGravity:
      return kMinGravityRad;
    case RobotMetric::kSuccess:
      return kMinSuccess;
    default:
      return kMinRatio;
  }
}

// More is worse for gravity, less is worse for the others.
double WorseBy(RobotMetric metric, double own, double others) {
  return metric == RobotMetric::kGravity ? own - others : others - own;
}

struct Value {
  std::size_t session = 0;  // its index
  double value = 0.0;
  double queries = 0.0;
};

// One session against the others' sessions, or one robot's sessions together.
struct Difference {
  double own = 0.0;
  double others = 0.0;
  double worse_by = 0.0;
  double surely_worse_by = 0.0;  // than those before and those after, whichever were worse
  double references = 0.0;       // sessions of others, in the segment with fewest
  double chance = 0.0;           // variance that drawing successes alone gives; 0 for other metrics
};

using SegmentValues = std::map<SegmentId, std::vector<Value>>;

SegmentValues ValuesOf(RobotMetric metric, std::span<const RobotSession> sessions) {
  SegmentValues values;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    std::map<SegmentId, std::vector<const Observation*>> seen;
    for (const Observation& o : sessions[i].observations) {
      if (o.segment >= 0) seen[o.segment].push_back(&o);
    }
    for (const auto& [segment, observations] : seen) {
      const auto value = ValueOf(metric, observations, kMinQueries);
      if (value) values[segment].push_back({i, *value, static_cast<double>(observations.size())});
    }
  }
  return values;
}

// A number for each session's robot.
std::vector<std::size_t> NumberRobots(std::span<const RobotSession> sessions) {
  std::map<std::string_view, std::size_t> numbers;
  std::vector<std::size_t> robots;
  for (const RobotSession& session : sessions) {
    robots.push_back(numbers.try_emplace(session.robot, numbers.size()).first->second);
  }
  return robots;
}

SegmentReferences ReferencesIn(std::span<const Value> values,
                               std::span<const RobotSession> sessions,
                               std::span<const std::size_t> robots) {
  std::vector<TimedValue> timed;
  for (const Value& value : values) {
    timed.push_back({sessions[value.session].start_unix_ns, value.value, robots[value.session]});
  }
  return SegmentReferences(timed);
}

// Medians of many differences; the worst supported one tells the references.
Difference MedianOf(std::span<const Difference> differences) {
  std::vector<double> own, others, worse_by, surely_worse_by;
  double references = differences.front().references;
  double chance = 0.0;
  for (const Difference& d : differences) {
    chance += d.chance;
    own.push_back(d.own);
    others.push_back(d.others);
    worse_by.push_back(d.worse_by);
    surely_worse_by.push_back(d.surely_worse_by);
    references = std::min(references, d.references);
  }
  const auto count = static_cast<double>(differences.size());
  // The variance of a median: that of a mean of as many values, times pi / 2.
  if (differences.size() > 1) chance *= kMedianVariance / (count * count);
  return {Median(std::move(own)),
          Median(std::move(others)),
          Median(std::move(worse_by)),
          Median(std::move(surely_worse_by)),
          references,
          chance};
}

// Variance of a share of `count` queries that succeed with the others' share (half a success and
// half a failure added, so that a spotless fleet does not predict perfection).
double ChanceOf(double share, double count) {
  const double mean = (share * count + 0.5) / (count + 1.0);
  return mean * (1.0 - mean) / count;
}

// One session's value in a segment; nullopt: no other robot was there. Where the map has changed,
// the nearest sessions are from before and from after the change, and their median is neither.
std::optional<Difference> DifferenceIn(RobotMetric metric, const Value& value, std::int64_t time,
                                       std::size_t robot, const SegmentReferences& references) {
  std::vector<double> others = references.Nearest(time, robot, kMaxReferences);
  if (others.empty()) return std::nullopt;
  Difference difference;
  difference.own = value.value;
  difference.references = static_cast<double>(others.size());
  difference.others = Median(std::move(others));
  difference.worse_by = WorseBy(metric, value.value, difference.others);
  difference.surely_worse_by = difference.worse_by;
  for (auto side : {references.Earlier(time, robot, kMaxReferences),
                    references.Later(time, robot, kMaxReferences)}) {
    if (side.empty()) continue;
    const double worse_by = WorseBy(metric, value.value, Median(std::move(side)));
    difference.surely_worse_by = std::min(difference.surely_worse_by, worse_by);
  }
  if (metric == RobotMetric::kSuccess) {
    difference.chance = ChanceOf(difference.others, value.queries);
  }
  return difference;
}

// By session; sessions that share no segment with another robot are left out.
std::map<std::size_t, Difference> SessionDifferences(RobotMetric metric,
                                                     std::span<const RobotSession> sessions) {
  std::map<std::size_t, std::vector<Difference>> by_session;
  const std::vector<std::size_t> robots = NumberRobots(sessions);
  for (const auto& [segment, values] : ValuesOf(metric, sessions)) {
    const SegmentReferences references = ReferencesIn(values, sessions, robots);
    for (const Value& value : values) {
      const auto difference = DifferenceIn(metric, value, sessions[value.session].start_unix_ns,
                                           robots[value.session], references);
      if (difference) by_session[value.session].push_back(*difference);
    }
  }
  std::map<std::size_t, Difference> differences;
  for (const auto& [session, parts] : by_session) differences[session] = MedianOf(parts);
  return differences;
}

// How much sessions of one robot scatter, robust against robots that differ.
struct Scatter {
  double sigma = 0.0;
  double freedom = 0.0;  // degrees of freedom of the estimate
};

// From the differences between two sessions of one robot, whose median is 0.954 sigma however few
// sessions a robot has (about a median of its own, few sessions scatter less than they do: three by
// 44%, six by 16%). Neighbours alone, so that thousands of sessions take no time.
Scatter ScatterOf(const std::map<std::string, std::vector<Difference>>& by_robot, double concern) {
  constexpr std::size_t kMostApart = 20;
  constexpr double kFreedomOfFloor = 1000.0;
  std::vector<double> between;
  double freedom = 0.0;
  for (const auto& [robot, differences] : by_robot) {
    for (std::size_t i = 0; i < differences.size(); ++i) {
      for (std::size_t j = i - std::min(i, kMostApart); j < i; ++j) {
        between.push_back(std::abs(differences[i].worse_by - differences[j].worse_by));
      }
    }
    const auto count = static_cast<double>(differences.size());
    freedom += (count - 1.0) * (0.75 - 0.9 / count);  // its efficiency, measured for 2 to 60
  }
  const Scatter floor{kFloorOfConcern * concern, kFreedomOfFloor};
  if (between.empty()) return floor;
  const double sigma = kSigmaOfMad / std::numbers::sqrt2 * Median(std::move(between));
  return sigma > floor.sigma ? Scatter{sigma, std::max(freedom, 1.0)} : floor;
}

// The probability that Student's t exceeds `t` (Wallace's approximation by the normal one).
double ExceedsByChance(double t, double freedom) {
  const double correction = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
  const double z = std::copysign(correction * std::sqrt(freedom * std::log1p(t * t / freedom)), t);
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

RobotDifference Judge(RobotMetric metric, const Difference& difference, double own_variance,
                      const Scatter& scatter, double concern, double false_alarm) {
  const double references = std::max(1.0, difference.references);
  const double sigma =
      std::sqrt(scatter.sigma * scatter.sigma * (own_variance + kMedianVariance / references) +
                difference.chance);
  RobotDifference judged{metric, difference.own, difference.others, difference.worse_by / sigma,
                         false};
  judged.stands_out = difference.worse_by >= concern &&
                      ExceedsByChance(judged.deviation, scatter.freedom) < false_alarm;
  return judged;
}

bool AnyStandsOut(std::span<const RobotDifference> differences) {
  return std::any_of(differences.begin(), differences.end(),
                     [](const RobotDifference& d) { return d.stands_out; });
}

bool ContradictsGravity(const Observation& o) {
  return o.evidence.gravity_rejected || o.outcome == Outcome::kGravityInconsistent;
}

// One query may be wrong, and so may two.
bool AreMost(std::int64_t contradicting, std::int64_t queries) {
  return contradicting >= 3 && 2 * contradicting > queries;
}

FleetComparison CountSessions(std::span<const RobotSession> sessions) {
  std::map<std::string, RobotComparison> robots;
  FleetComparison fleet;
  for (const RobotSession& session : sessions) {
    RobotComparison& robot = robots[session.robot];
    robot.robot = session.robot;
    ++robot.sessions;
    robot.queries += static_cast<std::int64_t>(session.observations.size());
    for (const Observation& o : session.observations) {
      robot.localized += o.outcome == Outcome::kLocalized ? 1 : 0;
      robot.calibration_inconsistent += o.outcome == Outcome::kCalibrationInconsistent ? 1 : 0;
      robot.gravity_rejected += ContradictsGravity(o) ? 1 : 0;
    }
    fleet.sessions.push_back({session.session, {}});
  }
  for (auto& [name, robot] : robots) fleet.robots.push_back(std::move(robot));
  return fleet;
}

void CompareIn(RobotMetric metric, std::span<const RobotSession> sessions, FleetComparison& fleet) {
  const double concern = ConcernOf(metric);
  const auto differences = SessionDifferences(metric, sessions);
  std::map<std::string, std::vector<Difference>> by_robot;
  for (const auto& [session, d] : differences) by_robot[sessions[session].robot].push_back(d);
  const Scatter scatter = ScatterOf(by_robot, concern);
  const double share = kFalseAlarm / static_cast<double>(kRobotMetrics.size());
  for (const auto& [session, d] : differences) {
    Difference sure = d;
    sure.worse_by = d.surely_worse_by;
    fleet.sessions[session].differences.push_back(Judge(
        metric, sure, 1.0, scatter, concern, share / static_cast<double>(fleet.sessions.size())));
  }
  for (RobotComparison& robot : fleet.robots) {
    const auto found = by_robot.find(robot.robot);
    if (found == by_robot.end()) continue;
    const double variance = kMedianVariance / static_cast<double>(found->second.size());
    robot.differences.push_back(Judge(metric, MedianOf(found->second), variance, scatter, concern,
                                      share / static_cast<double>(fleet.robots.size())));
  }
}

}  // namespace

std::string_view RobotMetricName(RobotMetric metric) {
  switch (metric) {
    case RobotMetric::kGravity:
      return "gravity";
    case RobotMetric::kPoints:
      return "points";
    case RobotMetric::kLines:
      return "lines";
    case RobotMetric::kSuccess:
      return "success";
  }
  return "unknown";
}

bool RobotComparison::StandsOut() const { return AnyStandsOut(differences); }
bool SessionComparison::StandsOut() const { return AnyStandsOut(differences); }

bool RobotComparison::CalibrationIsOff() const {
  return AreMost(calibration_inconsistent, queries);
}

bool RobotComparison::GravityIsOff() const { return AreMost(gravity_rejected, queries); }

FleetComparison CompareRobots(std::span<const RobotSession> sessions) {
  FleetComparison fleet = CountSessions(sessions);
  if (fleet.robots.size() < 2) return fleet;
  for (const RobotMetric metric : kRobotMetrics) CompareIn(metric, sessions, fleet);
  return fleet;
}

}  // namespace maploc
