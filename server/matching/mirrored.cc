#include "server/matching/mirrored.h"

#include <cmath>
#include <cstddef>
#include <span>

#include "server/matching/segment_matching.h"

namespace maploc {
namespace {

// Looked at first, spread over all.
constexpr int kPoints = 1000;
// A photo is mirrored if its descriptors match more than kMore times as often when turned over, and
// the difference exceeds kSigmas of its standard deviations. Honest photos of a symmetric front
// reach 1.04 times, mirrored ones 1.56 at least (README.md).
constexpr double kMore = 1.25;
constexpr double kSigmas = 4.0;

// SIFT's layout: 4 rows of 4 cells of 8 directions each, in the frame of the keypoint's own
// direction. A mirrored patch has its rows in the opposite order, and its directions run the other
// way about.
constexpr int kCells = 4;
constexpr int kDirections = 8;
constexpr int kSiftBytes = kCells * kCells * kDirections;

bool IsSift(const DescriptorKind& kind) {
  return kind.name.starts_with("sift") && kind.bytes == kSiftBytes;
}

void AppendMirrored(std::span<const std::uint8_t> sift, std::vector<std::uint8_t>& bytes) {
  for (int row = kCells - 1; row >= 0; --row) {
    for (int cell = 0; cell < kCells; ++cell) {
      const std::span<const std::uint8_t> directions =
          sift.subspan((row * kCells + cell) * kDirections, kDirections);
      for (int i = 0; i < kDirections; ++i) {
        bytes.push_back(directions[(kDirections - i) % kDirections]);
      }
    }
  }
}

double MatchCount(const Camera& camera, const Descriptors& descriptors, const Segment& segment) {
  const View view{camera, {}, {{}, descriptors}, {}};
  return static_cast<double>(MatchSegment(view, segment).points.size());
}

struct Counts {
  double sent = 0.0;
  double turned = 0.0;

  bool MoreTurned() const { return turned > kMore * sent; }
  bool IsSure() const { return turned - sent > kSigmas * std::sqrt(turned + sent); }
};

// The matches of every `step`-th point.
Counts CountMatches(const View& view, const Segment& segment, int step) {
  const Descriptors& all = view.points.descriptors;
  Descriptors sent{all.kind, {}};
  Descriptors mirrored{all.kind, {}};
  for (int i = 0; i < all.size(); i += step) {
    const std::span<const std::uint8_t> row = all.row(i);
    sent.bytes.insert(sent.bytes.end(), row.begin(), row.end());
    AppendMirrored(row, mirrored.bytes);
  }
  return {MatchCount(view.camera, sent, segment), MatchCount(view.camera, mirrored, segment)};
}

}  // namespace

bool MatchesBetterMirrored(const View& view, const Segment& segment) {
  const Descriptors& all = view.points.descriptors;
  if (!IsSift(all.kind)) return false;
  const int step = 1 + (all.size() - 1) / kPoints;
  Counts counts = CountMatches(view, segment, step);
  if (!counts.MoreTurned()) return false;
  // A segment that holds a part of the scene has few matches of either kind.
  if (!counts.IsSure() && step > 1) counts = CountMatches(view, segment, 1);
  return counts.MoreTurned() && counts.IsSure();
}

}  // namespace maploc
