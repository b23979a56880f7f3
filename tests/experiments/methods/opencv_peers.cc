#include <vector>

#include "tests/experiments/methods/cpu_timer.h"
#include "tests/experiments/methods/method.h"
#include "tests/experiments/methods/opencv_pose.h"

namespace maploc::experiments {
namespace {

// Points alone: OpenCV knows no lines.
struct CvProblem {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  cv::Matx33d camera;
};

CvProblem ToCv(const PoseProblem& problem) {
  CvProblem cv_problem;
  for (const PointCorrespondence& point : problem.points) {
    const Eigen::Vector3d& p = point.position_in_map;
    const Eigen::Vector2d pixel = point.normalized * problem.focal_length_px;
    cv_problem.points.emplace_back(p.x(), p.y(), p.z());
    cv_problem.pixels.emplace_back(pixel.x(), pixel.y());
  }
  const double f = problem.focal_length_px;
  cv_problem.camera = cv::Matx33d(f, 0, 0, 0, f, 0, 0, 0, 1);
  return cv_problem;
}

// OpenCV has no least number of iterations: a confidence of almost one makes it use them all.
double Confidence(const MethodOptions& options) {
  return options.min_iterations >= options.max_iterations ? 1 - 1e-12 : options.confidence;
}

// The answer is the peer's own refined pose. The conversion is not timed.
MethodAnswer SolvePnpRansac(const PoseProblem& problem, const MethodOptions& options, int flags) {
  const CvProblem cv_problem = ToCv(problem);
  cv::setNumThreads(1);
  cv::Mat turn, translation;
  bool found = false;
  const CpuTimer timer;
  try {
    found = cv::solvePnPRansac(cv_problem.points, cv_problem.pixels, cv_problem.camera,
                               cv::noArray(), turn, translation, false, options.max_iterations,
                               static_cast<float>(options.threshold_px), Confidence(options),
                               cv::noArray(), flags);
  } catch (const cv::Exception&) {
    // It throws where it has too few points or finds nothing.
  }
  MethodAnswer answer;
  answer.ms = timer.ElapsedMs();
  if (found) answer.camera_from_map = ToRigid3(turn, translation);
  return answer;
}

Method MakeMethod(const std::string& name, int flags) {
  Method method;
  method.name = name;
  method.solve = [flags](const PoseProblem& problem, const MethodOptions& options) {
    return SolvePnpRansac(problem, options, flags);
  };
  return method;
}

}  // namespace

std::vector<Method> OpenCvMethods() {
  return {MakeMethod("opencv-ap3p", cv::SOLVEPNP_AP3P),
          MakeMethod("opencv-magsac", cv::USAC_MAGSAC)};
}

}  // namespace maploc::experiments
