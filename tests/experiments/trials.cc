#include "tests/experiments/trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/experiments/progress.h"
#include "tests/experiments/protocol.h"

namespace maploc::experiments {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Outcomes {
  std::vector<double> rotation_deg, translation_percent, ms, ransac_ms, iterations;
  int right = 0;
};

bool IsRight(Success success, double rotation_deg, double translation_percent, double position) {
  if (success == Success::kPaper) return rotation_deg < 5.0 && translation_percent < 10.0;
  return rotation_deg < 1.0 && position < 0.25;
}

void Add(const MethodAnswer& answer, const Rigid3& truth, Success success, Outcomes& outcomes) {
  double rotation_deg = kInfinite, translation_percent = kInfinite, position = kInfinite;
  if (answer.camera_from_map) {
    const testing::PoseError error = testing::ComparePoses(*answer.camera_from_map, truth);
    rotation_deg = error.rotation_rad / kDegree;
    position = error.position;
    translation_percent = 100.0 * (answer.camera_from_map->translation - truth.translation).norm() /
                          truth.translation.norm();
  }
  outcomes.rotation_deg.push_back(rotation_deg);
  outcomes.translation_percent.push_back(translation_percent);
  outcomes.ms.push_back(answer.ms);
  outcomes.ransac_ms.push_back(answer.ransac_ms);
  outcomes.iterations.push_back(answer.iterations);
  outcomes.right += IsRight(success, rotation_deg, translation_percent, position) ? 1 : 0;
}

void PutFinite(Row& row, const std::string& key, double value) {
  if (std::isfinite(value)) row[key] = value;
}

Row MakeRow(const Setting& setting, const Method& method, const Outcomes& outcomes) {
  Row row;
  row["experiment"] = setting.keys.at("experiment");
  row["method"] = method.name;
  for (const auto& [key, value] : setting.keys.items()) row[key] = value;
  const double trials = static_cast<double>(outcomes.ms.size());
  row["trials"] = outcomes.ms.size();
  row["success_rate"] = outcomes.right / trials;
  PutFinite(row, "median_rotation_error_deg", Quantile(outcomes.rotation_deg, 0.5));
  PutFinite(row, "median_translation_error_percent", Quantile(outcomes.translation_percent, 0.5));
  row["median_ms"] = Quantile(outcomes.ms, 0.5);
  row["p99_ms"] = Quantile(outcomes.ms, 0.99);
  const double ransac_ms = Quantile(outcomes.ransac_ms, 0.5);
  if (ransac_ms > 0) row["median_ransac_ms"] = ransac_ms;
  const double iterations =
      std::accumulate(outcomes.iterations.begin(), outcomes.iterations.end(), 0.0) / trials;
  if (iterations > 0) row["mean_iterations"] = iterations;
  return row;
}

void RunSetting(const Setting& setting, const RunOptions& options, Rows& rows) {
  std::vector<const Method*> methods;
  const bool has_lines = setting.synthetic.line_inliers + setting.synthetic.line_outliers > 0;
  for (const std::string& name : options.methods) {
    const Method& method = MethodByName(name);
    if (has_lines || !method.needs_lines) methods.push_back(&method);
  }
  std::vector<Outcomes> outcomes(methods.size());
  for (int trial = 0; trial < options.trials; ++trial) {
    Random random = TrialRandom(options.seed, setting.keys.dump(), trial);
    MethodOptions limits = setting.limits;
    limits.seed = random.Next();
    const testing::SyntheticProblem made = testing::MakeSyntheticProblem(setting.synthetic, random);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      Add(methods[i]->solve(made.problem, limits), made.camera_from_map, setting.success,
          outcomes[i]);
    }
  }
  for (std::size_t i = 0; i < methods.size(); ++i) {
    rows.push_back(MakeRow(setting, *methods[i], outcomes[i]));
  }
}

}  // namespace

Result<Rows> RunSettings(const std::vector<Setting>& settings, const RunOptions& options) {
  std::vector<const Setting*> asked;
  for (const Setting& setting : settings) {
    MAPLOC_ASSIGN_OR_RETURN(const bool matches, Matches(setting.keys, options.only));
    if (matches) asked.push_back(&setting);
  }
  if (asked.empty()) {
    return InvalidArgument("--only", "no setting has these values; leave it out to see them all");
  }
  Rows rows;
  Progress progress(settings.front().keys.at("experiment"), static_cast<int>(asked.size()));
  for (const Setting* setting : asked) {
    RunSetting(*setting, options, rows);
    progress.Step();
  }
  return rows;
}

Random TrialRandom(std::uint64_t seed, const std::string& name, int trial) {
  return Random(HashBytes(name, seed ^ HashBytes("maploc-experiments")))
      .Fork(static_cast<std::uint64_t>(trial));
}

Result<bool> Matches(const Row& keys, const std::vector<std::string>& only) {
  bool matches = true;
  for (const std::string& condition : only) {
    const std::size_t equals = condition.find('=');
    if (equals == std::string::npos) {
      return InvalidArgument("--only", "'" + condition + "' is not KEY=VALUE");
    }
    matches = matches && HasValue(keys, condition.substr(0, equals), condition.substr(equals + 1));
  }
  return matches;
}

double Quantile(std::vector<double> values, double p) {
  const double rank = std::ceil(p * static_cast<double>(values.size())) - 1;
  const std::size_t index = static_cast<std::size_t>(std::max(rank, 0.0));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index),
                   values.end());
  return values[index];
}

}  // namespace maploc::experiments
