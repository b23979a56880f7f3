// What became of the queries of one lie on one set.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapstore/model/localization.h"
#include "tests/experiments/lies/recorded_sets.h"
#include "tests/experiments/row.h"

namespace maploc::lies {

// Off: beyond 0.25 m or 5 degrees; wrong: beyond 1 m or 10 degrees. Where a map has no unit, right
// is within 2% of the scene's depth and 2 degrees, and wrong is beyond 5% or 5 degrees.
struct Answered {
  bool localized = false;
  bool off = false;
  bool wrong = false;
  double translation = 0.0;  // map units
  double relative = 0.0;     // of the scene's depth
  double rotation_deg = 0.0;
  double sigmas = 0.0;  // the position's error over the root of its covariance's trace
};

Answered Compare(const Localization& answer, const HonestQuery& honest, bool metric);

// Not thread-safe.
class Tally {
 public:
  void Add(const Localization& answer, const Answered& compared);
  int queries() const { return queries_; }
  experiments::Row ToRow(const std::string& set, const Lie& lie) const;

 private:
  int queries_ = 0, localized_ = 0, right_ = 0, off_ = 0, wrong_ = 0, gravity_rejected_ = 0;
  std::map<Outcome, int> outcomes_;
  std::vector<double> translations_, relatives_, rotations_deg_, sigmas_, server_ms_;
};

}  // namespace maploc::lies
