// Eigen is compiled for the baseline architecture here as in the whole project: Debian's OpenGV is,
// and Eigen's aligned allocation changes with -mavx.
#include <cmath>
#include <memory>

#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/absolute_pose/AbsolutePoseSacProblem.hpp>

#include "tests/experiments/methods/cpu_timer.h"
#include "tests/experiments/methods/method.h"

namespace maploc::experiments {
namespace {

using Problem = opengv::sac_problems::absolute_pose::AbsolutePoseSacProblem;

constexpr std::size_t kSample = 4;  // three points, and a fourth to choose among the solutions

double Probability(const MethodOptions& options) {
  return options.min_iterations >= options.max_iterations ? 1 - 1e-12 : options.confidence;
}

// OpenGV's transformation is map_from_camera.
Rigid3 ToCameraFromMap(const opengv::transformation_t& map_from_camera) {
  const Eigen::Matrix3d rotation = map_from_camera.leftCols<3>().transpose();
  return {Eigen::Quaterniond(rotation).normalized(), -(rotation * map_from_camera.col(3))};
}

// Kneip's P3P in OpenGV's Ransac, then its own nonlinear optimization over the inliers. The input
// is shuffled a trial, so that OpenGV's fixed seed draws anew.
MethodAnswer SolveP3pRansac(const PoseProblem& problem, const MethodOptions& options) {
  MethodAnswer answer;
  if (problem.points.size() < kSample) return answer;
  opengv::bearingVectors_t rays;
  opengv::points_t points;
  for (const PointCorrespondence& point : problem.points) {
    rays.push_back(point.normalized.homogeneous().normalized());
    points.push_back(point.position_in_map);
  }
  const CpuTimer timer;
  opengv::absolute_pose::CentralAbsoluteAdapter adapter(rays, points);
  opengv::sac::Ransac<Problem> ransac(
      options.max_iterations,
      1.0 - std::cos(std::atan(options.threshold_px / problem.focal_length_px)),
      Probability(options));
  ransac.sac_model_ = std::make_shared<Problem>(adapter, Problem::KNEIP, false);
  const bool found = ransac.computeModel();
  answer.iterations = ransac.iterations_;
  answer.ransac_ms = timer.ElapsedMs();
  if (found) {
    opengv::transformation_t pose = ransac.model_coefficients_;
    if (ransac.inliers_.size() >= kSample) {
      ransac.sac_model_->optimizeModelCoefficients(ransac.inliers_, ransac.model_coefficients_,
                                                   pose);
    }
    if (pose.allFinite()) answer.camera_from_map = ToCameraFromMap(pose);
  }
  answer.ms = timer.ElapsedMs();
  return answer;
}

}  // namespace

std::vector<Method> OpenGvMethods() {
  Method method;
  method.name = "opengv-p3p";
  method.solve = SolveP3pRansac;
  return {method};
}

}  // namespace maploc::experiments
