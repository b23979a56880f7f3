// Answers to many sightings, one after the other, summed up and compared with another lens's
// answers to the very same.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "mapstore/base/median.h"
#include "mapstore/model/localization.h"
#include "tests/integration/any_camera/place.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {

class Scores {
 public:
  // Errors of position are told in units of so many metres.
  Scores(std::string name, double unit_m) : name_(std::move(name)), unit_m_(unit_m) {}

  void Add(const Localization& answer, const Rigid3& body_from_map) {
    const bool localized = answer.outcome == Outcome::kLocalized;
    const PoseError error = localized ? ComparePoses(answer.map_from_body->Inverse(), body_from_map)
                                      : PoseError{kNone, kNone};
    rotations_rad_.push_back(error.rotation_rad);
    positions_.push_back(localized ? error.position / unit_m_ : kNone);
    if (localized) {
      over_sigmas_.push_back(error.position /
                             std::sqrt(answer.covariance.topLeftCorner<3, 3>().trace()));
    }
  }

  double Localized() const {
    return ShareOf([](double, double t) { return t < kNone; });
  }
  // LOCALIZED beyond 5 degrees or 0.3 units of a scene that is 4 units away.
  double Wrong() const {
    return ShareOf(
        [](double r, double t) { return t < kNone && (r > 5.0 * kRadPerDeg || t > 0.3); });
  }
  double MedianRotationDeg() const { return Median(rotations_rad_) / kRadPerDeg; }
  double MedianPosition() const { return Median(positions_); }

  // How many times as large these errors are as those, in the geometric mean over what both
  // localized: the same noise is in both, which medians would not see.
  double RotationRatio(const Scores& other) const {
    return MeanRatio(rotations_rad_, other.rotations_rad_);
  }
  double PositionRatio(const Scores& other) const {
    return MeanRatio(positions_, other.positions_);
  }

  // Of the error of position over what the answer's covariance says of it.
  double MedianOverSigma() const { return Median(over_sigmas_); }

  void Print() const {
    std::printf("%-26s localized %.3f, wrong %.3f, median %.3f deg %.4f units, %.2f sigmas\n",
                name_.c_str(), Localized(), Wrong(), MedianRotationDeg(), MedianPosition(),
                MedianOverSigma());
  }
  const std::string& name() const { return name_; }

 private:
  static constexpr double kNone = 1e9;

  template <typename Holds>
  double ShareOf(const Holds& holds) const {
    int count = 0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      count += holds(rotations_rad_[i], positions_[i]) ? 1 : 0;
    }
    return count / static_cast<double>(positions_.size());
  }

  static double MeanRatio(const std::vector<double>& these, const std::vector<double>& those) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < these.size(); ++i) {
      if (these[i] == kNone || those[i] == kNone) continue;
      sum += std::log(these[i] / those[i]);
      ++count;
    }
    return std::exp(sum / count);
  }

  std::string name_;
  double unit_m_;
  std::vector<double> rotations_rad_;
  std::vector<double> positions_;
  std::vector<double> over_sigmas_;
};

}  // namespace maploc::testing
