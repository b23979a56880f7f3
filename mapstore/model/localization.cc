#include "mapstore/model/localization.h"

namespace maploc {

std::string_view OutcomeName(Outcome outcome) {
  switch (outcome) {
    case Outcome::kLocalized:
      return "LOCALIZED";
    case Outcome::kTooFewMatches:
      return "TOO_FEW_MATCHES";
    case Outcome::kNoConsensus:
      return "NO_CONSENSUS";
    case Outcome::kLowConfidence:
      return "LOW_CONFIDENCE";
    case Outcome::kGravityInconsistent:
      return "GRAVITY_INCONSISTENT";
    case Outcome::kOutOfMap:
      return "OUT_OF_MAP";
    case Outcome::kCalibrationInconsistent:
      return "CALIBRATION_INCONSISTENT";
  }
  return "UNKNOWN";
}

}  // namespace maploc
