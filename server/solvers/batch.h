// up2p and up1p1l for many samples at once, over plain arrays of double (structure of arrays),
// dispatched at run time by Google Highway (SSE2, SSE4, AVX2, AVX-512, NEON). The equations,
// frames, preconditions and degeneracies are those of up2p.h and up1p1l.h; the depths of two points
// in a shorter form (batch.cc).
//
// Every array holds `count` numbers, without padding or alignment; outputs must not overlap inputs.
// Samples whose conditioning w (yaw_equation.h) is below `min_conditioning` have no solution.
// Returned is how many are not below.
//
// Solutions: two a sample, `first` and `second`, in the order of the roots. One that does not exist
// or has a depth that is not positive is marked by a cosine that is NaN; its other numbers mean
// nothing. They agree with the scalar kernels up to rounding (fused multiplications), and do not
// depend on count or place.
//
// No Eigen types here: the kernels are compiled for several targets. Thread-safe.
#pragma once

#include <cstddef>

namespace maploc {

struct VectorArrays {
  const double* x;
  const double* y;
  const double* z;
};

// aligned_from_map.
struct AlignedPoseArrays {
  double* cosine;
  double* sine;
  double* x;
  double* y;
  double* z;
};

struct Up2pArrays {
  VectorArrays ray1, point1, ray2, point2;
  std::size_t count = 0;
  double min_conditioning = 0.0;
};

struct Up1p1lArrays {
  VectorArrays ray, point, plane_normal, line_point, line_direction;
  std::size_t count = 0;
  double min_conditioning = 0.0;
};

std::size_t SolveUp2pBatch(const Up2pArrays& samples, const AlignedPoseArrays& first,
                           const AlignedPoseArrays& second);
std::size_t SolveUp1p1lBatch(const Up1p1lArrays& samples, const AlignedPoseArrays& first,
                             const AlignedPoseArrays& second);

}  // namespace maploc
