#include "server/trust/calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "server/refinement/covariance.h"
#include "server/trust/lens_fit.h"

namespace maploc {
namespace {

// Standard deviations (log s, c_x, c_y, k). What a lens may be at all: only a bound, so that few
// matches cannot ask for a lens that nobody makes.
const LensValues kAnyLens(0.7, 0.1, 0.1, 0.3);
// The same where all but the focal length is as it is said to be.
const LensValues kFocalAlone(1.0, 0.004, 0.004, 0.008);
// What nobody would call a wrong calibration.
const LensValues kExact(0.002, 0.002, 0.002, 0.004);
// What calibrations are usually off by, beyond that: 0.8% of the focal length.
const LensValues kUsual(0.008, 0.008, 0.008, 0.016);

// Chi-square: one in 200,000 of four degrees of freedom. Honest queries of `euroc_v101`: at most 15
// (MEASUREMENTS.md).
constexpr double kMaxDistance2 = 30.0;
// From here on, one in a hundred, another lens is not known but suspected.
constexpr double kSuspectedDistance2 = 13.3;
// Least gain of support. True lenses gain at most 4% (tourists' photos of a flat front) and 5% (a
// wall with errors of depth); a focal length 2% off before a court of depth gains 10%
// (MEASUREMENTS.md).
constexpr double kClearGain = 0.06;
// The same for a fit that does not end. Lenses that are truly three times as long as sent and more
// gain at least 23% before a sheet tilted by half a radian (MEASUREMENTS.md).
constexpr double kRunawayGain = 0.16;
// The matches determine the focal length up to this standard deviation. Beyond it, all values of a
// lens together fit a sheet that the map has bent, and mean nothing.
constexpr double kMostFocalSigma = 0.1;
// A flat front leaves little to gain by any lens: there a focal length is beyond doubt where it is
// four standard deviations off, of its own and of what a map's bends make of one (2%). True lenses:
// 2.2 (tourists' photos), 3.0 (the wall).
constexpr double kBentFocal = 0.02;
constexpr double kMaxBentDistance2 = 16.0;
// Four values of a lens find something to gain among the wrong matches near a few dozen inliers.
constexpr std::size_t kLeastForAnyLens = 60;
// A threshold far beyond the noise would take every lens for a small gain: this many times the
// inliers' root mean square is enough for all that agree.
constexpr double kThresholdRms = 4.0;

// A fit, and how far it is from the calibration that was sent.
struct Found {
  LensValues lens = LensValues::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double distance2 = 0.0;
  double gain = 0.0;  // of the support
  bool converged = true;
  int features = 0;

  bool Contradicts() const {
    return distance2 > kMaxDistance2 && gain >= (converged ? kClearGain : kRunawayGain);
  }
};

double Distance2(const Found& found) {
  Eigen::Matrix4d spread = found.covariance;
  spread.diagonal() += kExact.cwiseAbs2();
  return found.lens.dot(spread.ldlt().solve(found.lens));
}

// What is told of the focal length. An error in a landmark's depth looks like relief, and relief is
// what a focal length is seen by: an error that moves the projection by e adds e^2 to the
// information, and pulls towards a longer lens. If all residuals (two a feature, as large as the
// noise) come from depths, they make this much of the focal length. What contradicts the sent lens
// is decided without this bound: with it 13 more of 1440 answers under a wrong calibration are
// wrong (MEASUREMENTS.md).
double ToldSigma(const Found& found) {
  const double variance = found.covariance(0, 0);
  return std::hypot(std::sqrt(variance), 2.0 * static_cast<double>(found.features) * variance);
}

double FocalSigma(const Found& found) { return std::sqrt(found.covariance(0, 0)); }

double FocalDistance2(const Found& found, double tolerance) {
  return found.lens(0) * found.lens(0) / (found.covariance(0, 0) + tolerance * tolerance);
}

// Where the matches leave the focal length open (a sheet seen through a narrow lens), the fit may
// run away to any.
bool IsFarOff(const Found& focal) {
  return FocalSigma(focal) <= kMostFocalSigma &&
         FocalDistance2(focal, kBentFocal) > kMaxBentDistance2;
}

// Nothing is found where there is too little to tell.
std::optional<Found> FitLens(LensFit& fit, const LensValues& prior, double support) {
  if (!fit.Fit(prior)) return std::nullopt;
  Found found;
  found.lens = fit.lens();
  found.covariance = fit.Covariance();
  found.gain = fit.Support() / support - 1.0;
  found.converged = fit.converged();
  found.features = fit.features();
  return found;
}

// The lens' own uncertainty after the matches have spoken, and the lens that is suspected: its mean
// where `kUsual` is what was believed before.
Eigen::Matrix4d Uncertainty(const LensResponse& response, const Found& found) {
  Eigen::Matrix4d information = response.information;
  information.diagonal() += kUsual.cwiseAbs2().cwiseInverse();
  Eigen::Matrix4d uncertainty = information.inverse();
  if (found.distance2 <= kSuspectedDistance2) return uncertainty;
  Eigen::Matrix4d spread = found.covariance;
  spread.diagonal() += kUsual.cwiseAbs2();
  const LensValues mean =
      kUsual.cwiseAbs2().asDiagonal() * LensValues(spread.ldlt().solve(found.lens));
  uncertainty += mean * mean.transpose();
  return uncertainty;
}

// Its features are seen by rays, not in the plane that a lens bends.
bool IsWide(const PoseProblem& problem) {
  return std::ranges::any_of(problem.points,
                             [](const auto& point) { return point.frame.has_value(); }) ||
         std::ranges::any_of(problem.lines,
                             [](const auto& line) { return line.frames.has_value(); });
}

}  // namespace

CalibrationCheck CheckCalibration(const PoseProblem& problem, const RefinedPose& pose,
                                  double max_reprojection_error_px) {
  CalibrationCheck check;
  if (IsWide(problem)) return check;
  LensFit fit(problem, pose,
              std::min(max_reprojection_error_px, kThresholdRms * pose.inlier_rms_px));
  const PoseMatrix as_sent = fit.camera_from_moved_map();
  const LensResponse response = fit.Response();
  const double support = fit.Support();
  Found any;
  if (auto focal = FitLens(fit, kFocalAlone, support)) {
    focal->distance2 = FocalDistance2(*focal, kExact(0));
    const double sigma = ToldSigma(*focal);
    if (sigma <= kMostFocalSigma) check.focal_scale = FocalScale{std::exp(focal->lens(0)), sigma};
    const auto found =
        pose.InlierCount() < kLeastForAnyLens ? std::nullopt : FitLens(fit, kAnyLens, support);
    if (found && FocalSigma(*found) <= kMostFocalSigma) {
      any = *found;
      any.distance2 = Distance2(any);
    }
    check.consistent = !focal->Contradicts() && !any.Contradicts() && !IsFarOff(*focal);
  }
  check.covariance = CovarianceOfMapFromCamera(
      as_sent, response.of_pose * Uncertainty(response, any) * response.of_pose.transpose());
  return check;
}

}  // namespace maploc
