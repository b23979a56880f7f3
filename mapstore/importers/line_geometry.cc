#include "mapstore/importers/line_geometry.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

namespace maploc {
namespace {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix34 = Eigen::Matrix<double, 3, 4>;

constexpr double kHuberPx = 1.0;

Vector3 Homogeneous(const Vector2& p) { return {p.x(), p.y(), 1.0}; }

// The residual of one end point and its derivative by the four parameters.
struct Equation {
  double residual_px;
  Eigen::RowVector4d jacobian;
};

// d = x . n / |n_xy| with n = A x B. A and B move by `motion_a`, `motion_b` times the parameters.
Equation MakeEquation(const LineObservation& view, const Vector3& x, const LineSegment3& line,
                      const Matrix34& motion_a, const Matrix34& motion_b) {
  const Eigen::Matrix3d rotation = view.camera_from_map.rotation.toRotationMatrix();
  const Vector3 a = view.camera_from_map * line.start;
  const Vector3 b = view.camera_from_map * line.end;
  const Vector3 n = a.cross(b);
  const double norm = n.head<2>().norm();
  const Matrix34 da = rotation * motion_a;
  const Matrix34 db = rotation * motion_b;
  Matrix34 dn;
  for (int k = 0; k < 4; ++k) dn.col(k) = da.col(k).cross(b) + a.cross(db.col(k));
  const double d = x.dot(n) / norm;
  const Eigen::RowVector4d dnorm = n.head<2>().transpose() * dn.topRows<2>() / norm;
  const Eigen::RowVector4d dd = (x.transpose() * dn - d * dnorm) / norm;
  return {view.focal_length_px * d, view.focal_length_px * dd};
}

struct NormalEquations {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
};

// Each end of the line moves across it, in two directions. A move along it changes no residual and
// would make the equations singular.
struct Basis {
  Vector3 u, v;
  Matrix34 motion_a = Matrix34::Zero();
  Matrix34 motion_b = Matrix34::Zero();

  explicit Basis(const LineSegment3& line) {
    const Vector3 direction = (line.end - line.start).normalized();
    u = direction.unitOrthogonal();
    v = direction.cross(u);
    motion_a.col(0) = motion_b.col(2) = u;
    motion_a.col(1) = motion_b.col(3) = v;
  }
};

NormalEquations Accumulate(std::span<const LineObservation> views, const LineSegment3& line,
                           const Basis& basis) {
  NormalEquations sum;
  for (const LineObservation& view : views) {
    for (const Vector2& end : {view.normalized.start, view.normalized.end}) {
      const Equation e = MakeEquation(view, Homogeneous(end), line, basis.motion_a, basis.motion_b);
      // Huber's weight: 1 up to kHuberPx, beyond it the smaller the larger the error.
      const double weight = std::min(1.0, kHuberPx / std::max(std::abs(e.residual_px), 1e-12));
      sum.information += weight * e.jacobian.transpose() * e.jacobian;
      sum.gradient += weight * e.jacobian.transpose() * e.residual_px;
    }
  }
  return sum;
}

// Where along the line (from its start, in its direction) the end point's ray passes it.
double PositionAlong(const LineObservation& view, const Vector2& end, const LineSegment3& line) {
  const Rigid3 map_from_camera = view.camera_from_map.Inverse();
  const Vector3 ray = (map_from_camera.rotation * Homogeneous(end)).normalized();
  const Vector3 direction = (line.end - line.start).normalized();
  const Vector3 offset = line.start - map_from_camera.translation;
  const double cosine = ray.dot(direction);
  // The closest points of two lines; the denominator is positive, since the ray is not along the
  // line (it would project to a point).
  return (cosine * ray.dot(offset) - direction.dot(offset)) / std::max(1 - cosine * cosine, 1e-12);
}

// nullopt when the views see no common stretch.
std::optional<LineSegment3> Bound(std::span<const LineObservation> views,
                                  const LineSegment3& line) {
  std::vector<double> starts, ends;
  for (const LineObservation& view : views) {
    const double a = PositionAlong(view, view.normalized.start, line);
    const double b = PositionAlong(view, view.normalized.end, line);
    starts.push_back(std::min(a, b));
    ends.push_back(std::max(a, b));
  }
  std::sort(starts.begin(), starts.end());
  std::sort(ends.begin(), ends.end(), std::greater<>());
  const std::size_t rank = views.size() >= 3 ? 1 : 0;
  if (!(starts[rank] < ends[rank])) return std::nullopt;
  const Vector3 direction = (line.end - line.start).normalized();
  return LineSegment3{line.start + starts[rank] * direction, line.start + ends[rank] * direction};
}

}  // namespace

std::optional<LineSegment3> IntersectPlanes(const LineObservation& a, const LineObservation& b,
                                            double min_angle_rad) {
  const Vector3 plane =
      Homogeneous(b.normalized.start).cross(Homogeneous(b.normalized.end)).normalized();
  const Rigid3 map_from_a = a.camera_from_map.Inverse();
  const Rigid3 b_from_a = b.camera_from_map * map_from_a;
  const double offset = plane.dot(b_from_a.translation);
  const double min_sine = std::sin(min_angle_rad);
  const auto lift = [&](const Vector2& end) -> std::optional<Vector3> {
    const Vector3 ray = Homogeneous(end);
    const Vector3 ray_in_b = b_from_a.rotation * ray;
    const double sine = plane.dot(ray_in_b);
    if (!(std::abs(sine) >= min_sine * ray.norm())) return std::nullopt;
    const double depth = -offset / sine;
    if (!(depth > 0) || !((depth * ray_in_b + b_from_a.translation).z() > 0)) return std::nullopt;
    return map_from_a * Vector3(depth * ray);
  };
  const std::optional<Vector3> start = lift(a.normalized.start);
  const std::optional<Vector3> end = lift(a.normalized.end);
  if (!start || !end || !((*end - *start).norm() > 0)) return std::nullopt;
  const Vector3 start_in_b = b.camera_from_map * *start;
  const Vector3 end_in_b = b.camera_from_map * *end;
  const Vector2 direction =
      end_in_b.head<2>() / end_in_b.z() - start_in_b.head<2>() / start_in_b.z();
  if (!(direction.dot(b.normalized.end - b.normalized.start) > 0)) return std::nullopt;
  return LineSegment3{*start, *end};
}

std::optional<LineSegment2> ProjectSegment(const Rigid3& camera_from_map,
                                           const LineSegment3& line_in_map) {
  const Vector3 start = camera_from_map * line_in_map.start;
  const Vector3 end = camera_from_map * line_in_map.end;
  if (!(start.z() > 0) || !(end.z() > 0)) return std::nullopt;
  return LineSegment2{start.head<2>() / start.z(), end.head<2>() / end.z()};
}

bool SegmentsAgree(const LineSegment2& a, const LineSegment2& b, double max_error,
                   double min_overlap) {
  const double length2_a = (a.end - a.start).squaredNorm();
  const double length2_b = (b.end - b.start).squaredNorm();
  const LineSegment2& longer = length2_a >= length2_b ? a : b;
  const LineSegment2& shorter = length2_a >= length2_b ? b : a;
  if (!(std::min(length2_a, length2_b) > 0)) return false;
  const double length = std::sqrt(std::max(length2_a, length2_b));
  // LSD directs a segment by its dark side, so two views of one line run the same way.
  const Vector2 direction = (longer.end - longer.start) / length;
  const Vector2 normal(-direction.y(), direction.x());
  if (!(std::abs(normal.dot(shorter.start - longer.start)) <= max_error)) return false;
  if (!(std::abs(normal.dot(shorter.end - longer.start)) <= max_error)) return false;
  const double from = direction.dot(shorter.start - longer.start);
  const double to = direction.dot(shorter.end - longer.start);
  if (!(to > from)) return false;
  const double shorter_length = std::sqrt(std::min(length2_a, length2_b));
  return std::min(to, length) - std::max(from, 0.0) >= min_overlap * shorter_length;
}

bool ShowsLine(const LineObservation& seen, const LineSegment3& line_in_map, double max_error_px,
               double min_overlap) {
  const std::optional<LineSegment2> projected = ProjectSegment(seen.camera_from_map, line_in_map);
  return projected && SegmentsAgree(seen.normalized, *projected,
                                    max_error_px / seen.focal_length_px, min_overlap);
}

std::optional<RefinedLine> RefineLine(std::span<const LineObservation> views,
                                      const LineSegment3& start_in_map) {
  constexpr int kMaxSteps = 15;
  constexpr double kConverged = 1e-9;        // a step, as a share of the line's length
  constexpr double kMinInformation = 1e-10;  // smallest over largest eigenvalue
  LineSegment3 line = start_in_map;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double length = (line.end - line.start).norm();
    if (!(length > 0) || !line.start.allFinite() || !line.end.allFinite()) return std::nullopt;
    const Basis basis(line);
    const NormalEquations equations = Accumulate(views, line, basis);
    if (!equations.information.allFinite()) return std::nullopt;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(equations.information);
    const Eigen::Vector4d& eigenvalues = solver.eigenvalues();
    // Views whose planes nearly coincide leave the line open in one direction.
    if (!(eigenvalues(0) > kMinInformation * eigenvalues(3))) return std::nullopt;
    const Eigen::Matrix4d covariance = solver.eigenvectors() *
                                       eigenvalues.cwiseInverse().asDiagonal() *
                                       solver.eigenvectors().transpose();
    const Eigen::Vector4d delta = -(covariance * equations.gradient);
    line.start += basis.motion_a * delta;
    line.end += basis.motion_b * delta;
    if (delta.norm() > kConverged * length && step + 1 < kMaxSteps) continue;
    const auto spread = [&](int block) {
      const Eigen::Matrix2d part = covariance.block<2, 2>(block, block);
      return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(part).eigenvalues()(1));
    };
    const std::optional<LineSegment3> bounded = Bound(views, line);
    if (!bounded || !bounded->start.allFinite() || !bounded->end.allFinite()) break;
    return RefinedLine{*bounded, std::max(spread(0), spread(2))};
  }
  return std::nullopt;
}

}  // namespace maploc
