// Draws minimal samples, gates the degenerate ones, solves the rest: a block of draws at a time
// (sample_block.h).
//
// 2P: two points. 1P1L: a point and a usable line. mixed: a point, then one of all the remaining
// points and usable lines. Where DrawsVerticalLines (mapstore/model/strategy.h) says so, vertical
// lines join the draw of 1P1L's and mixed's second entity; a vertical line asks for a second one
// (1P2V). P3P: three points, no gravity.
//
// Where matches carry ratios, draws begin among the surest (draw_pool.h).
//
// Gates: conditioning w (server/solvers/yaw_equation.h) of at least sin 10 degrees; two points at
// least 10 px apart in the image; a point at least 10 px off the image line. When fewer than half
// of the draws of a block pass, all gates are halved.
#pragma once

#include <cstdint>

#include "mapstore/base/random.h"
#include "mapstore/model/strategy.h"
#include "server/ransac/draw_pool.h"
#include "server/ransac/prepared_problem.h"
#include "server/ransac/sample_block.h"

namespace maploc {

// Not thread-safe. `prepared` must outlive it.
class Sampler {
 public:
  Sampler(const PreparedProblem& prepared, Strategy strategy);

  // Whether a sample of the strategy exists at all. Nothing else may be called when not.
  bool CanDraw() const;
  // The next sample: count 0 when the draw was gated out or has no valid solution. Until the next
  // call.
  const Hypotheses& Draw(Random& random);
  // The vertical lines take part.
  bool draws_vertical_lines() const { return draw_vertical_; }

 private:
  // What may be drawn now, of each kind: the pools are the first so many of the prepared orders.
  struct Pools {
    std::uint32_t points = 0;
    std::uint32_t usable_lines = 0;
    std::uint32_t vertical_lines = 0;  // 0 where they do not take part
    std::uint32_t lines() const { return usable_lines + vertical_lines; }
  };

  Pools CurrentPools() const;
  void FillBlock(Random& random);
  // Each of these adds one sample to the block, or AddRejected. Those that the block does not gate
  // count in passed_.
  void AddDraw(Random& random);
  void AddMixed(const Pools& pools, std::uint32_t first, Random& random);
  void AddTwoPoints(std::uint32_t first, std::uint32_t second);
  // `entity` counts usable lines, then vertical ones.
  void AddPointAndLineEntity(const Pools& pools, std::uint32_t point, std::uint32_t entity,
                             Random& random);
  void AddPointAndLine(std::uint32_t point, std::uint32_t line);
  void AddPointAndVerticals(std::uint32_t point, std::uint32_t line, std::uint32_t other);
  void AddThreePoints(const Pools& pools, std::uint32_t first, Random& random);

  const PreparedProblem& prepared_;
  const Strategy strategy_;
  const bool draw_vertical_;
  DrawPool pool_;
  double gate_ = 1.0;  // factor on all gates
  SampleBlock block_;
  int next_ = 0;    // of the block
  int passed_ = 0;  // of the block's draws
};

}  // namespace maploc
