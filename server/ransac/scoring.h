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
// Units: the camera's plane z = 1, or what frames are scaled to. No Eigen types here: the kernels
// are compiled for several targets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace maploc {

// Arrays are padded to a multiple of this many with features that can never score.
inline constexpr std::size_t kScoringPad = 16;

// Seen either in the plane z = 1 or by frames (pixel_frame.h), all alike.
struct PointArrays {
  std::vector<float> x, y, z;               // in the map
  std::vector<float> u, v;                  // seen in the plane; or
  std::array<std::vector<float>, 9> frame;  // ray, then the two rows of `across`
  std::size_t count = 0;                    // without the padding

  bool has_frames() const { return !frame[0].empty(); }
  void Add(const float position[3], float seen_u, float seen_v);
  void Add(const float position[3], const float of_frame[9]);
  void Pad();

 private:
  void AddPosition(const float position[3]);
};

struct LineArrays {
  std::vector<float> x, y, z;                 // start in the map
  std::vector<float> dx, dy, dz;              // end - start
  std::vector<float> u0, v0, u1, v1;          // seen end points in the plane; or
  std::array<std::vector<float>, 18> frames;  // of each end ray, then the two rows of the gradient
  std::vector<float> scale;                   // with frames: image length a radian
  std::size_t count = 0;

  bool has_frames() const { return !scale.empty(); }
  void Add(const float start[3], const float direction[3], const float seen[4]);
  void Add(const float start[3], const float direction[3], const float of_ends[18],
           float of_length);
  void Pad();

 private:
  void AddSegment(const float start[3], const float direction[3]);
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

// How many of the points [begin, end) score: ScorePoints' inliers, but for those within rounding of
// the threshold, in less time.
int CountScoringPoints(const PointArrays& points, std::size_t begin, std::size_t end,
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
