// When did a segment change, and in what? (design.md section 6)
#pragma once

namespace maploc {

// A share `good / total` that is worth no more than `independent` independent trials.
struct Proportion {
  double good = 0.0;
  double total = 0.0;
  double independent = 0.0;
};

// How many standard deviations the share of `fresh` lies above (or, negative, below) what `old`
// predicts for it: the scatter of both counts together. Jeffreys' mean (half a good and half a bad
// one added), so that a spotless record does not predict perfection. 0 where either is empty.
double DeviationOf(const Proportion& old, const Proportion& fresh);

// Outside the 99% interval.
bool IsChanged(const Proportion& old, const Proportion& fresh);

}  // namespace maploc
