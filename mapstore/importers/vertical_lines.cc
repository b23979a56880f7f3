#include "mapstore/importers/vertical_lines.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "mapstore/base/angles.h"
#include "mapstore/base/random.h"

namespace maploc {
namespace {

constexpr std::size_t kLongestSegments = 300;  // of a photo: short ones have no direction
constexpr int kHypotheses = 3000;
// How far a segment's direction may be off the vanishing point's, in the search and in the fit.
constexpr double kMaxOffRad = 1.0 * kRadPerDeg;
// Nearer to the vanishing point any direction fits.
constexpr double kMinSineFromVertical = 0.3;
// Where to look: within four standard deviations of the levels, and within 45 degrees, beyond which
// a line that is called vertical lies.
constexpr double kSearchSigmas2 = 16.0;
constexpr double kMaxFromLevels = 45 * kRadPerDeg;
constexpr int kMinVerticalsInPhoto = 5;
constexpr int kMinPhotos = 3;
// Another family, more than 5 degrees away, with over 60% of the votes: which is vertical is a
// guess.
constexpr double kOtherFamily = 5 * kRadPerDeg;
constexpr double kMaxRivalShare = 0.6;
// Masonry and lenses: verticals of real fronts agree with gravity to this (MEASUREMENTS.md).
constexpr double kVerticalSigmaRad = 0.2 * kRadPerDeg;

struct PlaneNormal {
  Eigen::Vector3d normal;  // in source, unit
  Eigen::Vector3d middle;  // the ray to the segment's middle, in source, unit
  double length = 0.0;     // in the normalized plane
};
using PhotoNormals = std::vector<PlaneNormal>;

PhotoNormals TakeNormals(const Eigen::Quaterniond& camera_from_source, const FrameLines& lines) {
  PhotoNormals normals;
  for (const LineSegment2& segment : lines.normalized) {
    const Eigen::Vector3d start = segment.start.homogeneous();
    const Eigen::Vector3d end = segment.end.homogeneous();
    normals.push_back({camera_from_source.conjugate() * start.cross(end).normalized(),
                       camera_from_source.conjugate() * (start + end).normalized(),
                       (segment.end - segment.start).norm()});
  }
  const std::size_t kept = std::min(kLongestSegments, normals.size());
  std::partial_sort(normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(kept),
                    normals.end(),
                    [](const auto& a, const auto& b) { return a.length > b.length; });
  normals.resize(kept);
  return normals;
}

// The sine of the angle, in the picture, between the segment and the way to v's vanishing point; 1
// where the segment is too near that point.
double Off(const PlaneNormal& n, const Eigen::Vector3d& v) {
  const double from_vertical = n.middle.cross(v).norm();
  return from_vertical < kMinSineFromVertical ? 1.0 : n.normal.dot(v) / from_vertical;
}

class Search {
 public:
  Search(std::span<const Eigen::Quaterniond> camera_from_source, std::span<const FrameLines> lines,
         const CameraLevels& levels)
      : levels_(levels.down_in_source) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      photos_.push_back(TakeNormals(camera_from_source[i], lines[i]));
      for (const PlaneNormal& n : photos_.back()) all_.push_back(&n);
    }
    // A segment's own noise is no evidence against the levels.
    levels_.covariance += Eigen::Matrix3d::Identity() * (kMaxOffRad * kMaxOffRad);
  }

  std::optional<Eigen::Vector3d> FindPeak() const {
    std::vector<std::pair<double, Eigen::Vector3d>> scored;
    // A fixed seed: the same photos always give the same direction.
    Random random(1);
    const auto count = static_cast<std::uint32_t>(all_.size());
    for (int i = 0; count > 1 && i < kHypotheses; ++i) {
      const auto v = Propose(*all_[random.Below(count)], *all_[random.Below(count)]);
      if (v) scored.emplace_back(Votes(*v), *v);
    }
    if (scored.empty()) return std::nullopt;
    const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto best = std::max_element(scored.begin(), scored.end(), less);
    for (const auto& [votes, v] : scored) {
      const bool is_other = std::abs(v.dot(best->second)) < std::cos(kOtherFamily);
      if (is_other && votes > kMaxRivalShare * best->first) return std::nullopt;
    }
    return best->second;
  }

  std::optional<VerticalLines> Refine(Eigen::Vector3d v) const {
    VerticalLines found;
    for (int i = 0; i < 10; ++i) {
      const Eigen::Matrix<double, 3, 2> basis = TangentBasis(v);
      const std::vector<PhotoSum> sums = SumPhotos(v, basis);
      found.photos = static_cast<int>(sums.size());
      if (found.photos < kMinPhotos) return std::nullopt;
      Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
      Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
      Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
      found.segments = 0;
      for (const PhotoSum& sum : sums) {
        information += sum.information;
        gradient += sum.gradient;
        scatter += sum.gradient * sum.gradient.transpose();
        found.segments += sum.segments;
      }
      // The covariance is from the scatter between photos, because the segments of one photo share
      // its errors.
      const Eigen::Matrix2d inverse = information.inverse();
      const double factor = SmallSampleFactor(found.photos - 2);
      found.down_in_source.covariance =
          basis * (factor * inverse * scatter * inverse) * basis.transpose() +
          kVerticalSigmaRad * kVerticalSigmaRad * basis * basis.transpose();
      v = (v - basis * (inverse * gradient)).normalized();
      found.down_in_source.direction = v;
    }
    return found;
  }

 private:
  struct PhotoSum {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    int segments = 0;
  };

  std::optional<Eigen::Vector3d> Propose(const PlaneNormal& a, const PlaneNormal& b) const {
    Eigen::Vector3d v = a.normal.cross(b.normal);
    if (v.norm() < 0.02) return std::nullopt;  // one plane, seen twice
    v.normalize();
    if (v.dot(levels_.direction) < 0) v = -v;
    if (v.dot(levels_.direction) < std::cos(kMaxFromLevels)) return std::nullopt;
    if (Distance2({v, Eigen::Matrix3d::Zero()}, levels_) > kSearchSigmas2) return std::nullopt;
    return v;
  }

  // The share of each photo's segments that point to v, by length, summed: no photo votes twice.
  double Votes(const Eigen::Vector3d& v) const {
    double votes = 0.0;
    for (const PhotoNormals& photo : photos_) {
      double length = 0.0;
      // Not 0, so that a photo without segments gives no vote instead of 0 / 0.
      double total = 1e-9;
      for (const PlaneNormal& n : photo) {
        total += n.length;
        if (std::abs(Off(n, v)) < kMaxOffRad) length += n.length;
      }
      votes += length / total;
    }
    return votes;
  }

  // One step's sums for each photo that shows enough verticals; Tukey's weight by the length, which
  // is what a segment's direction is good for.
  std::vector<PhotoSum> SumPhotos(const Eigen::Vector3d& v,
                                  const Eigen::Matrix<double, 3, 2>& basis) const {
    std::vector<PhotoSum> sums;
    for (const PhotoNormals& photo : photos_) {
      PhotoSum sum;
      for (const PlaneNormal& n : photo) {
        const double off = Off(n, v);
        if (std::abs(off) >= kMaxOffRad) continue;
        const double weight = std::pow(1 - std::pow(off / kMaxOffRad, 2), 2) * n.length;
        const Eigen::Vector2d row = basis.transpose() * n.normal / n.middle.cross(v).norm();
        sum.information += weight * row * row.transpose();
        sum.gradient += weight * off * row;
        ++sum.segments;
      }
      if (sum.segments >= kMinVerticalsInPhoto) sums.push_back(sum);
    }
    return sums;
  }

  DirectionFit levels_;
  std::vector<PhotoNormals> photos_;
  std::vector<const PlaneNormal*> all_;  // into photos_, whose entries stay where they are
};

}  // namespace

std::optional<VerticalLines> FindVerticalLines(
    std::span<const Eigen::Quaterniond> camera_from_source, std::span<const FrameLines> lines,
    const CameraLevels& levels) {
  const Search search(camera_from_source, lines, levels);
  const std::optional<Eigen::Vector3d> peak = search.FindPeak();
  return peak ? search.Refine(*peak) : std::nullopt;
}

}  // namespace maploc
