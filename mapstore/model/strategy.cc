#include "mapstore/model/strategy.h"

namespace maploc {

bool DrawsVerticalLines(Strategy strategy, std::size_t usable_lines, std::size_t vertical_lines) {
  // A draw of two vertical lines needs both to be right, so 1P1L draws them only if usable lines
  // are few. In mixed they compete with points as well (server/ransac/README.md).
  if (vertical_lines < 2 || vertical_lines <= usable_lines) return false;
  return strategy == Strategy::kMixed ||
         (strategy == Strategy::k1P1L && usable_lines < kEnoughUsableLines);
}

std::string_view StrategyName(Strategy strategy) {
  switch (strategy) {
    case Strategy::k1P1L:
      return "1p1l";
    case Strategy::k2P:
      return "2p";
    case Strategy::kMixed:
      return "mixed";
    case Strategy::kP3P:
      return "p3p";
  }
  return "unknown";
}

std::optional<Strategy> StrategyFromName(std::string_view name) {
  for (const Strategy s : {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed, Strategy::kP3P}) {
    if (StrategyName(s) == name) return s;
  }
  return std::nullopt;
}

std::string_view StrategySourceName(StrategySource source) {
  switch (source) {
    case StrategySource::kDefault:
      return "default";
    case StrategySource::kLearned:
      return "learned";
    case StrategySource::kPinned:
      return "pinned";
    case StrategySource::kRequested:
      return "requested";
  }
  return "unknown";
}

std::string_view RefinementName(Refinement refinement) {
  switch (refinement) {
    case Refinement::kAuto:
      return "auto";
    case Refinement::k4Dof:
      return "4dof";
    case Refinement::k6Dof:
      return "6dof";
  }
  return "unknown";
}

std::optional<Refinement> RefinementFromName(std::string_view name) {
  for (const Refinement r : {Refinement::kAuto, Refinement::k4Dof, Refinement::k6Dof}) {
    if (RefinementName(r) == name) return r;
  }
  return std::nullopt;
}

}  // namespace maploc
