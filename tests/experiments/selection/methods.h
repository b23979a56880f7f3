// Every method of the experiment on one and the same matched problem.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/strategy.h"
#include "server/refinement/refine.h"

namespace maploc::selection {

inline constexpr std::array<std::string_view, 11> kMethods = {
    "1p1l-4dof",  "1p1l-6dof",  "1p1l-auto",  "2p-4dof", "2p-6dof", "2p-auto",
    "mixed-4dof", "mixed-6dof", "mixed-auto", "p3p",     "epnp"};
inline constexpr int kP3pMethod = 9;
inline constexpr int kEpnpMethod = 10;
inline constexpr int kMethodCount = static_cast<int>(kMethods.size());
inline constexpr std::array kStrategies = {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed};

// Index into kMethods of a strategy with the refinement that the product uses. REQUIRES: one of
// kStrategies.
int AutoMethodOf(Strategy strategy);

struct SearchLimits {
  int max_iterations = 100;
  double confidence = 0.999;
  bool fall_back = false;
};

struct Attempt {
  std::optional<Rigid3> camera_from_map;  // nullopt: nothing found
  int iterations = 0;
  double search_ms = 0.0;  // processor time of this thread
  double ms = 0.0;         // with refinement
  RefinedPose refined;     // that camera_from_map is of; not of `p3p` and `epnp`
};

// One a method, in the order of kMethods. All strategies draw from the same seed; a strategy's
// refinements share its search. `p3p` and `epnp` are those of
// tests/experiments/methods, and know neither lines nor gravity.
std::vector<Attempt> TryAllMethods(const PoseProblem& problem, const SearchLimits& limits,
                                   std::uint64_t seed);

// One of them: a strategy with the refinement that the product uses, or P3P.
Attempt TryStrategy(const PoseProblem& problem, Strategy strategy, const SearchLimits& limits,
                    std::uint64_t seed);
Attempt TryP3p(const PoseProblem& problem, const SearchLimits& limits, std::uint64_t seed);

}  // namespace maploc::selection
