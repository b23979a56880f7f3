// A block of samples that are solved together: the batched solvers (server/solvers/batch.h) take
// all pairs of points, and all points with a line, at once. Samples of other kinds are solved when
// they are added. Taken out in the order in which they were added, so that the same draws give the
// same hypotheses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/ransac/prepared_problem.h"
#include "server/solvers/batch.h"

namespace maploc {

inline constexpr int kMaxPosesOfSample = 4;

// The features of a sample.
struct Sample {
  int point_count = 0;
  int line_count = 0;
  std::uint32_t points[3] = {0, 0, 0};  // indices into PreparedProblem::points
  std::uint32_t lines[2] = {0, 0};      // and ::lines
};

// A sample and the poses that it has.
struct Hypotheses {
  Sample sample;
  int count = 0;
  PoseMatrix camera_from_centred[kMaxPosesOfSample];
};

// Not thread-safe. `prepared` must outlive it.
class SampleBlock {
 public:
  static constexpr int kSize = 64;

  explicit SampleBlock(const PreparedProblem& prepared) : prepared_(prepared) {}

  // Forgets all samples.
  void Clear();
  // REQUIRES: fewer than kSize since Clear.
  void AddRejected() { Add(Kind::kRejected, 0); }
  void AddTwoPoints(const Sample& sample);
  void AddPointAndLine(const Sample& sample);
  void AddSolved(const Hypotheses& hypotheses);

  // Returns how many of the pairs of points, and points with a line, have at least this
  // conditioning (server/solvers/yaw_equation.h); the others get no pose.
  int Solve(double min_conditioning);

  int size() const { return size_; }
  // The i-th of the block, with no pose if it was rejected or has no valid one. After Solve; until
  // the next call.
  const Hypotheses& At(int i);

 private:
  enum class Kind : std::uint8_t { kRejected, kTwoPoints, kPointAndLine, kSolved };
  struct Entry {
    Kind kind = Kind::kRejected;
    int place = 0;  // among those of its kind
  };

  // Numbers of all samples of one kind, an array for each (structure of arrays), with two poses a
  // sample. The `vectors` are the solver's inputs.
  template <int kVectors>
  struct Arrays {
    double vectors[kVectors][3][kSize];
    double poses[2][5][kSize];
    std::array<Sample, kSize> samples;
    int count = 0;

    void Add(const Sample& sample, const std::array<const Eigen::Vector3d*, kVectors>& values);
    VectorArrays In(int vector) const {
      return {vectors[vector][0], vectors[vector][1], vectors[vector][2]};
    }
    AlignedPoseArrays Out(int root) {
      auto& of_root = poses[root];
      return {of_root[0], of_root[1], of_root[2], of_root[3], of_root[4]};
    }
    void Get(int place, const PreparedProblem& prepared, Hypotheses& out) const;
  };

  void Add(Kind kind, int place) { entries_[size_++] = {kind, place}; }

  const PreparedProblem& prepared_;
  std::array<Entry, kSize> entries_;
  int size_ = 0;
  Arrays<4> two_points_;
  Arrays<5> point_and_line_;
  std::vector<Hypotheses> solved_;
  Hypotheses current_;  // what At returned: one place, for its poses are written often
};

}  // namespace maploc
