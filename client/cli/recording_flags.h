// The flags that name a recorded robot, and the choices about sampling and refining, shared by
// commands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/robot/recorded_robot.h"
#include "client/robot/replay.h"

namespace maploc {

// --colmap, --database, --images, --gravity-csv, --gravity-noise-deg, --gravity-sigma-deg,
// --without-gravity, --max-features, --seed.
void AddRecordingFlags(CLI::App& command, RecordingOptions& options);

// --strategy, --refine and --max-error as they stand on the command line.
struct MethodFlags {
  std::string strategy = "auto";
  std::string refine = "auto";
  std::optional<double> max_error_px;

  std::optional<Strategy> RequestedStrategy() const { return StrategyFromName(strategy); }
  Refinement RequestedRefinement() const {
    return RefinementFromName(refine).value_or(Refinement::kAuto);
  }
};
void AddMethodFlags(CLI::App& command, MethodFlags& flags);

// KEY=VALUE each, as CLI11 has checked (LabelCheck).
std::map<std::string, std::string> ParseLabels(const std::vector<std::string>& labels);
CLI::Validator LabelCheck();

}  // namespace maploc
