// The one interface of everything that is compared: a problem in, a pose or none out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"

namespace maploc::experiments {

struct MethodOptions {
  double threshold_px = 3.0;  // inlier threshold
  double pixel_sigma = 1.0;   // what a refinement is told of the features' noise
  double confidence = 0.999;  // of the stop rule
  int min_iterations = 20;    // equal to max_iterations: no stop rule, exactly so many
  int max_iterations = 100;
  std::uint64_t seed = 1;
};

struct MethodAnswer {
  std::optional<Rigid3> camera_from_map;
  int iterations = 0;      // evaluated hypotheses; 0 where the method does not tell
  double ransac_ms = 0.0;  // the thread's processor time; 0 where refinement cannot be told apart
  double ms = 0.0;         // with refinement
};

// Deterministic: the same problem and options give the same pose. Not thread-safe (OpenCV's thread
// count is set to one for the whole process).
struct Method {
  std::string name;          // as on the command line
  bool needs_lines = false;  // it cannot draw a sample without
  std::function<MethodAnswer(const PoseProblem&, const MethodOptions&)> solve;
};

// One function a family, one file a function.
std::vector<Method> OurMethods();       // 1p1l, 2p, mixed: each -4dof, -6dof, -auto
std::vector<Method> BaselineMethods();  // p3p, epnp, 2p1l: our RANSAC with another minimal solver
std::vector<Method> OpenCvMethods();    // opencv-ap3p, opencv-magsac, as packaged
std::vector<Method> OpenGvMethods();    // opengv-p3p, as packaged

// All of them, in the order above.
const std::vector<Method>& AllMethods();
std::vector<std::string> AllMethodNames();
// REQUIRES: a name of AllMethodNames.
const Method& MethodByName(std::string_view name);

}  // namespace maploc::experiments
