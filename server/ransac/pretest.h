// A cheap look at a hypothesis before it is scored in full: does anything in a small random block
// of the features agree with it?
//
// A pose whose score is at least the best's, S, has inliers worth S somewhere among the points and
// lines. A block with the share kBlockScore / S of both kinds holds one of them with probability
// 1 - exp(-kBlockScore) = 95%, however they are divided between the kinds. So a pose without any
// inlier in the block, besides its own sample, is refused. One in twenty of the good ones is lost;
// the same pose is drawn again.
//
// The block is a fresh one for each hypothesis (a fixed one would judge all by the same few).
#pragma once

#include <cstddef>

#include "mapstore/base/random.h"
#include "server/ransac/prepared_problem.h"
#include "server/ransac/sample_block.h"
#include "server/ransac/scoring.h"

namespace maploc {

// Not thread-safe. `prepared` must outlive it.
class Pretest {
 public:
  Pretest(const PreparedProblem& prepared, const ScoringOptions& options);

  // Sizes the block for poses at least as good as one of `best_score`. Without a call everything
  // passes.
  void Update(double best_score);
  bool Passes(const Sample& sample, const ScoringPose& pose, Random& random) const;

 private:
  const PreparedProblem& prepared_;
  const ScoringOptions options_;
  std::size_t points_ = 0;  // size of the block: multiples of kScoringPad
  std::size_t lines_ = 0;
  bool useful_ = false;  // the block is much smaller than the whole
};

}  // namespace maploc
