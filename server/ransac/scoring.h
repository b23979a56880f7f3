// How well does a pose explain the matches? Float structure-of-arrays kernels, dispatched at run
// time by Google Highway (SSE4, AVX2, AVX-512, NEON).
//
// Score of a feature: 1 - e^2 / threshold^2 where that is positive (truncated quadratic), else 0.
//   * point: e is the distance of its projection; 0 behind the camera.
//   * line: e^2 is the mean of the two end points' squared distances to the projected map line; 0
//     when either is beyond the threshold, when the segment is behind the camera, and when its
//     projection is shorter than `min_line_length` (every image line passes through a dot).
// A point and a line weigh the same: each is two constraints, and the chance that a wrong match
// agrees is of the same order (disc over image; strip over image times angle).
//
// Units: the camera's plane z = 1. No Eigen types here: the kernels are compiled for several
// targets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace maploc {

// Arrays are padded to a multiple of this many with features that can never score.
inline constexpr std::size_t kScoringPad = 16;

struct PointArrays {
  std::vector<float> x, y, z;  // in the map
  std::vector<float> u, v;     // seen
  std::size_t count = 0;       // without the padding

  void Add(float px, float py, float pz, float pu, float pv);
  void Pad();
};

struct LineArrays {
  std::vector<float> x, y, z;         // start in the map
  std::vector<float> dx, dy, dz;      // end - start
  std::vector<float> u0, v0, u1, v1;  // seen end points
  std::size_t count = 0;

  void Add(const float start[3], const float direction[3], const float seen[4]);
  void Pad();
};

// camera_from_map, row-major.
struct ScoringPose {
  float rotation[9];
  float translation[3];
};

struct ScoringOptions {
  float threshold = 0.01f;
  float min_line_length = 0.01f;
};

struct Support {
  double score = 0.0;
  int inliers = 0;

  Support& operator+=(const Support& other) {
    score += other.score;
    inliers += other.inliers;
    return *this;
  }
};

// Scores the points [begin, end). REQUIRES: begin and end are multiples of kScoringPad, end within
// the padded arrays. Thread-safe.
Support ScorePoints(const PointArrays& points, std::size_t begin, std::size_t end,
                    const ScoringPose& pose, const ScoringOptions& options);

// Scores the lines [begin, end), as ScorePoints does points.
Support ScoreLines(const LineArrays& lines, std::size_t begin, std::size_t end,
                   const ScoringPose& pose, const ScoringOptions& options);

// The places in the arrays of all features that score (whose value above is positive), ascending.
// `places` grows to the padded size and is written up to the returned count: no allocation when
// it is reused. Thread-safe.
std::size_t FindScoringPoints(const PointArrays& points, const ScoringPose& pose,
                              const ScoringOptions& options, std::vector<std::uint32_t>* places);
std::size_t FindScoringLines(const LineArrays& lines, const ScoringPose& pose,
                             const ScoringOptions& options, std::vector<std::uint32_t>* places);

}  // namespace maploc
