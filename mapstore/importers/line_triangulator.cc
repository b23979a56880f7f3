#include "mapstore/importers/line_triangulator.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "mapstore/importers/line_candidates.h"

namespace maploc {
namespace {

constexpr int kMinFrames = 3;        // that show a landmark: two planes always meet in a line
constexpr double kMaxErrorPx = 2.0;  // of a view that a landmark keeps
constexpr double kMaxRelativeSigma =
    0.01;  // uncertainty across the line at 1 px of noise, over depth

// A line with the segments that show it; ascending by (frame, line).
struct Hypothesis {
  LineSegment3 line_in_map;
  std::vector<LineRef> views;
  int frames = 0;
  int distance_sum = 0;  // of the voters' descriptors; smaller is surer among equals

  bool IsBetterThan(const Hypothesis& other) const {
    if (frames != other.frames) return frames > other.frames;
    if (distance_sum != other.distance_sum) return distance_sum < other.distance_sum;
    // Only so that the order is the same on every run.
    return views < other.views;
  }
};

int CountFrames(const std::vector<LineRef>& views) {
  std::set<std::int32_t> frames;
  for (const LineRef& view : views) frames.insert(view.frame);
  return static_cast<int>(frames.size());
}

class Triangulator {
 public:
  explicit Triangulator(const LineViews& views) : views_(views) {}

  // Steps 1 and 2 for one segment; nullopt when too few frames show its line.
  std::optional<Hypothesis> Propose(LineRef line, const std::vector<int>& neighbours) const {
    std::vector<std::vector<LineCandidate>> candidates;
    for (const int other : neighbours) {
      candidates.push_back(FindLineCandidates(views_, line, other));
    }
    std::optional<Hypothesis> best;
    for (const auto& of_frame : candidates) {
      for (const LineCandidate& proposal : of_frame) {
        Hypothesis hypothesis = Vote(line, proposal, candidates);
        if (hypothesis.frames < kMinFrames) continue;
        if (!best || hypothesis.IsBetterThan(*best)) best = std::move(hypothesis);
      }
    }
    if (best && !Refine(*best)) return std::nullopt;
    return best;
  }

  // Takes each free segment that shows the line, in the views' frames and their neighbours, and
  // refines it once more. `taken` has one entry a frame and segment.
  bool Extend(Hypothesis& hypothesis, std::span<const std::vector<int>> neighbours,
              const std::vector<std::vector<char>>& taken) const {
    std::set<int> near;
    for (const LineRef& view : hypothesis.views) {
      near.insert(view.frame);
      const std::vector<int>& others = neighbours[static_cast<std::size_t>(view.frame)];
      near.insert(others.begin(), others.end());
    }
    // The proposal's own views come back here if they still show the refined line.
    std::vector<LineRef> showing;
    for (const int frame : near) {
      const std::optional<LineSegment2> projected =
          ProjectSegment(views_.CameraFromMap(frame), hypothesis.line_in_map);
      if (!projected) continue;
      for (std::int32_t line = 0; line < views_.LineCount(frame); ++line) {
        const LineRef ref{frame, line};
        if (taken[static_cast<std::size_t>(frame)][static_cast<std::size_t>(line)]) continue;
        if (Shows(ref, *projected, hypothesis)) showing.push_back(ref);
      }
    }
    hypothesis.views = std::move(showing);
    return Refine(hypothesis);
  }

  // Whether the refined line is certain enough. Sigma shrinks with the number of views.
  bool IsWellConditioned(const Hypothesis& hypothesis, double sigma_m) const {
    const Eigen::Vector3d middle = (hypothesis.line_in_map.start + hypothesis.line_in_map.end) / 2;
    double depth = std::numeric_limits<double>::max();
    for (const LineRef& view : hypothesis.views) {
      depth = std::min(depth, (views_.CameraFromMap(view.frame) * middle).z());
    }
    return sigma_m <= kMaxRelativeSigma * depth;
  }

 private:
  Hypothesis Vote(LineRef line, const LineCandidate& proposal,
                  const std::vector<std::vector<LineCandidate>>& candidates) const {
    Hypothesis hypothesis{proposal.line_in_map, {line}, 0, 0};
    for (const auto& of_frame : candidates) {
      if (of_frame.empty()) continue;
      const int frame = of_frame.front().other.frame;
      const std::optional<LineSegment2> projected =
          ProjectSegment(views_.CameraFromMap(frame), proposal.line_in_map);
      if (!projected) continue;
      const double max_error = kMaxVoteErrorPx / views_.FocalLengthPx(frame);
      for (const LineCandidate& voter : of_frame) {  // the nearest descriptor that agrees
        if (!SegmentsAgree(views_.Normalized(voter.other), *projected, max_error, kMinOverlap)) {
          continue;
        }
        hypothesis.views.push_back(voter.other);
        hypothesis.distance_sum += voter.distance;
        break;
      }
    }
    std::sort(hypothesis.views.begin(), hypothesis.views.end());
    hypothesis.frames = static_cast<int>(hypothesis.views.size());
    return hypothesis;
  }

  // Refines, drops the views beyond the error allowed, and refines what is left.
  bool Refine(Hypothesis& hypothesis) const {
    constexpr int kMaxRounds = 3;
    for (int round = 0; round < kMaxRounds; ++round) {
      hypothesis.frames = CountFrames(hypothesis.views);
      if (hypothesis.frames < kMinFrames) return false;
      std::vector<LineObservation> seen;
      for (const LineRef& view : hypothesis.views) seen.push_back(views_.Observation(view));
      const std::optional<RefinedLine> refined = RefineLine(seen, hypothesis.line_in_map);
      if (!refined) return false;
      hypothesis.line_in_map = refined->segment_in_map;
      const auto is_bad = [&](const LineRef& view) {
        return !ShowsLine(views_.Observation(view), hypothesis.line_in_map, kMaxErrorPx, 0.0);
      };
      if (std::erase_if(hypothesis.views, is_bad) == 0) {
        return IsWellConditioned(hypothesis, refined->sigma_m);
      }
    }
    return false;
  }

  bool Shows(LineRef ref, const LineSegment2& projected, const Hypothesis& hypothesis) const {
    if (!SegmentsAgree(views_.Normalized(ref), projected,
                       kMaxErrorPx / views_.FocalLengthPx(ref.frame), kMinOverlap)) {
      return false;
    }
    return std::any_of(hypothesis.views.begin(), hypothesis.views.end(), [&](const LineRef& view) {
      return views_.DescriptorDistance(ref, view) <= kMaxDescriptorDistance;
    });
  }

  const LineViews& views_;
};

std::vector<Hypothesis> ProposeAll(const LineViews& views, const Triangulator& triangulator,
                                   std::span<const std::vector<int>> neighbours,
                                   const ProgressFn& progress) {
  std::vector<std::vector<Hypothesis>> by_frame(neighbours.size());
  const int count = static_cast<int>(neighbours.size());
  ParallelFor(
      count,
      [&](int frame) {
        const auto index = static_cast<std::size_t>(frame);
        for (std::int32_t line = 0; line < views.LineCount(frame); ++line) {
          std::optional<Hypothesis> hypothesis =
              triangulator.Propose({frame, line}, neighbours[index]);
          if (hypothesis) by_frame[index].push_back(std::move(*hypothesis));
        }
      },
      [&](int done) {
        if (progress) progress("triangulating lines", done, count);
      });
  std::vector<Hypothesis> all;
  for (auto& of_frame : by_frame) {
    std::move(of_frame.begin(), of_frame.end(), std::back_inserter(all));
  }
  // The best first, because each line takes its segments away from those after it.
  std::sort(all.begin(), all.end(),
            [](const Hypothesis& a, const Hypothesis& b) { return a.IsBetterThan(b); });
  return all;
}

LineTrackInMap MakeTrack(const LineViews& views, const Hypothesis& hypothesis) {
  LineTrackInMap track{hypothesis.line_in_map, {}, {}};
  for (const LineRef& view : hypothesis.views) {
    // Views ascend by frame, and one frame can show a line in several pieces.
    if (track.frames.empty() || track.frames.back() != view.frame) {
      track.frames.push_back(view.frame);
    }
    const std::span<const std::uint8_t> row = views.Descriptor(view);
    track.descriptors.insert(track.descriptors.end(), row.begin(), row.end());
  }
  return track;
}

}  // namespace

std::vector<LineTrackInMap> TriangulateLines(std::span<const KeyFrame> frames,
                                             std::span<const FrameLines> lines,
                                             std::span<const std::vector<int>> neighbours,
                                             const ProgressFn& progress) {
  const LineViews views(frames, lines);
  const Triangulator triangulator(views);
  std::vector<std::vector<char>> taken;
  for (const FrameLines& of_frame : lines) taken.emplace_back(of_frame.normalized.size(), 0);
  const auto is_taken = [&](const LineRef& view) -> char& {
    return taken[static_cast<std::size_t>(view.frame)][static_cast<std::size_t>(view.line)];
  };
  std::vector<LineTrackInMap> tracks;
  for (Hypothesis& hypothesis : ProposeAll(views, triangulator, neighbours, progress)) {
    std::erase_if(hypothesis.views, [&](const LineRef& view) { return is_taken(view) != 0; });
    if (CountFrames(hypothesis.views) < kMinFrames) continue;
    if (!triangulator.Extend(hypothesis, neighbours, taken)) continue;
    for (const LineRef& view : hypothesis.views) is_taken(view) = 1;
    tracks.push_back(MakeTrack(views, hypothesis));
  }
  return tracks;
}

}  // namespace maploc
