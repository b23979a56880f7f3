// Does `auto` equal the better of 4 and 6 degrees of freedom? Told in the rows themselves.
#pragma once

#include "tests/experiments/row.h"

namespace maploc::experiments {

// Each row of a method NAME-auto whose setting also has NAME-4dof and NAME-6dof gets, for rotation
// and translation, its median error as a multiple of the smaller and of the larger one of theirs:
// rotation_to_better, rotation_to_worse, translation_to_better, translation_to_worse. Left out
// where an error is missing, and without pixel noise: there the sigma that a refinement is told (at
// least 0.1 px) is not the noise, and errors of 1e-8 degrees have no ratio worth telling.
Rows WithRefinementComparison(Rows rows);

}  // namespace maploc::experiments
