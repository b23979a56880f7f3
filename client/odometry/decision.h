// What became of an answer that was held against odometry.
#pragma once

#include <optional>
#include <string>

namespace maploc {

enum class Verdict {
  kTaken,                 // odometry agrees
  kPositionContradicted,  // held back
  kRotationContradicted,  // held back; its position agrees
  kUnconfirmed,           // held back: there is no pose yet
  kRelocated,             // as many answers as asked agreed on another place, or on a first one
};

// Between an answer and what odometry makes of the answers before.
struct Gap {
  double distance_m = 0.0;
  double angle_rad = 0.0;
  // The same in standard deviations, of the direction in which it is the most.
  double position_sigmas = 0.0;
  double rotation_sigmas = 0.0;
};

struct Decision {
  Verdict verdict = Verdict::kUnconfirmed;
  std::optional<Gap> gap;  // to the pose before this answer; unset where there was none
  int agreeing = 0;        // answers on this place so far, where it was held back

  // Whether the pose follows this answer.
  bool taken() const { return verdict == Verdict::kTaken || verdict == Verdict::kRelocated; }
  // For people: "held back: odometry contradicts its position by 2.31 m (14.2 sigma); ...".
  std::string Reason() const;
};

}  // namespace maploc
