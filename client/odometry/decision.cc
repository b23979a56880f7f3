#include "client/odometry/decision.h"

#include <cstdio>

namespace maploc {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

std::string Print(const char* format, double first, double second) {
  char text[128];
  std::snprintf(text, sizeof text, format, first, second);
  return text;
}

}  // namespace

std::string Decision::Reason() const {
  const std::string so_far = "; " + std::to_string(agreeing) + " on this place so far";
  switch (verdict) {
    case Verdict::kTaken:
      return "taken: odometry agrees";
    // What is contradicted is a gap, so that there is one.
    case Verdict::kPositionContradicted:
      return Print("held back: odometry contradicts its position by %.2f m (%.1f sigma)",
                   gap->distance_m, gap->position_sigmas) +
             so_far;
    case Verdict::kRotationContradicted:
      return Print("held back: odometry contradicts its rotation by %.1f degrees (%.1f sigma)",
                   gap->angle_rad * kDegreesPerRadian, gap->rotation_sigmas) +
             so_far;
    case Verdict::kUnconfirmed:
      return "held back: there is no pose yet" + so_far;
    case Verdict::kRelocated:
      return gap ? Print("taken: enough answers agree on a place %.2f m and %.1f degrees away",
                         gap->distance_m, gap->angle_rad * kDegreesPerRadian)
                 : "taken: enough answers agree on a first place";
  }
  return "";
}

}  // namespace maploc
