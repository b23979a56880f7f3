// How RANSAC draws its samples, how a pose is refined, and who said so.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace maploc {

// The names on command lines and in JSON are 1p1l, 2p, mixed, p3p (StrategyName).
enum class Strategy {
  k1P1L = 1,   // one point, one usable line
  k2P = 2,     // two points
  kMixed = 3,  // one point, then one of all remaining points and usable lines
  kP3P = 4,    // three points, no gravity; never chosen by the selector
};

enum class StrategySource {
  kDefault = 1,    // no evidence yet: mixed
  kLearned = 2,    // the selector, from statistics
  kPinned = 3,     // an operator
  kRequested = 4,  // the query asked for it
};

enum class Refinement {
  kAuto = 1,  // 6 degrees of freedom with gravity as a measurement of its sigma
  k4Dof = 2,  // yaw and translation; gravity held
  k6Dof = 3,  // gravity forgotten
};

// Whether vertical lines join the draw of a strategy's second entity (a vertical line asks for a
// second one: one point and two vertical lines). The sampler draws by it, the selector predicts by
// it.
// * mixed: where they outnumber the usable lines.
// * 1P1L: the same, and there are fewer than kEnoughUsableLines usable ones: a pair of vertical
//   lines is right only when both are, but so few usable ones may all be wrong.
inline constexpr std::size_t kEnoughUsableLines = 10;
bool DrawsVerticalLines(Strategy strategy, std::size_t usable_lines, std::size_t vertical_lines);

std::string_view StrategyName(Strategy strategy);
std::optional<Strategy> StrategyFromName(std::string_view name);
std::string_view StrategySourceName(
    StrategySource source);  // "default", "learned", "pinned", "requested"
std::string_view RefinementName(Refinement refinement);  // "auto", "4dof", "6dof"
std::optional<Refinement> RefinementFromName(std::string_view name);

}  // namespace maploc
