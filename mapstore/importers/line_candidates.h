// Step 1 of line triangulation: which segments of a neighbouring frame may show the same line.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mapstore/importers/line_geometry.h"
#include "mapstore/importers/line_triangulator.h"

namespace maploc {

// Bounds of a view of a line. Pixels are those of the photos as their features were found
// (KeyFrame::FeaturePixel).
inline constexpr int kMaxDescriptorDistance = 70;  // bits of 256 between views of one line
inline constexpr double kMinOverlap = 0.4;         // of the shorter of two segments
inline constexpr double kMaxVoteErrorPx = 2.5;     // of a view that votes for a proposal

// One segment of one frame.
struct LineRef {
  std::int32_t frame = 0;
  std::int32_t line = 0;
  auto operator<=>(const LineRef&) const = default;
};

struct LineCandidate {
  LineRef other;
  int distance = 0;          // bits between the descriptors
  LineSegment3 line_in_map;  // the asking segment, lifted to 3D by the other's plane
};

// All frames' segments, and how to see them.
class LineViews {
 public:
  // REQUIRES: descriptors of 32 bytes. The arguments outlive this.
  LineViews(std::span<const KeyFrame> frames, std::span<const FrameLines> lines);

  int LineCount(int frame) const { return static_cast<int>(Lines(frame).normalized.size()); }
  const Rigid3& CameraFromMap(int frame) const { return Frame(frame).camera_from_map; }
  double FocalLengthPx(int frame) const { return focal_px_[static_cast<std::size_t>(frame)]; }
  const LineSegment2& Normalized(LineRef ref) const {
    return Lines(ref.frame).normalized[static_cast<std::size_t>(ref.line)];
  }
  LineObservation Observation(LineRef ref) const {
    return {CameraFromMap(ref.frame), Normalized(ref), FocalLengthPx(ref.frame)};
  }
  std::span<const std::uint8_t> Descriptor(LineRef ref) const {
    return Lines(ref.frame).descriptors.row(ref.line);
  }
  // Bits.
  int DescriptorDistance(LineRef a, LineRef b) const;

 private:
  using Words = std::array<std::uint64_t, 4>;

  const KeyFrame& Frame(int frame) const { return frames_[static_cast<std::size_t>(frame)]; }
  const FrameLines& Lines(int frame) const { return lines_[static_cast<std::size_t>(frame)]; }
  const Words& DescriptorWords(LineRef ref) const {
    return words_[static_cast<std::size_t>(ref.frame)][static_cast<std::size_t>(ref.line)];
  }

  std::span<const KeyFrame> frames_;
  std::span<const FrameLines> lines_;
  std::vector<double> focal_px_;
  std::vector<std::vector<Words>> words_;
};

// The nearest by descriptor first, at most ten of the frame `other_frame`.
std::vector<LineCandidate> FindLineCandidates(const LineViews& views, LineRef line,
                                              int other_frame);

}  // namespace maploc
