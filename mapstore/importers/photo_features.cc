#include "mapstore/importers/photo_features.h"

#include <cmath>
#include <optional>
#include <utility>

namespace maploc {
namespace {

Result<GrayImage> LoadPhoto(const std::string& images_directory, const KeyFrame& frame) {
  const std::string path = images_directory + "/" + frame.name;
  MAPLOC_ASSIGN_OR_RETURN(GrayImage image, LoadGrayImage(path));
  if (image.width_px != frame.camera.width_px() || image.height_px != frame.camera.height_px()) {
    return InvalidFile(path, "is " + std::to_string(image.width_px) + "x" +
                                 std::to_string(image.height_px) + " pixels, but its camera has " +
                                 std::to_string(frame.camera.width_px()) + "x" +
                                 std::to_string(frame.camera.height_px()));
  }
  return image;
}

// detect(frame) for every frame; the first frame's error, if any.
template <typename T, typename Detect>
Result<std::vector<T>> DetectAll(std::span<const KeyFrame> frames, std::string_view stage,
                                 const ProgressFn& progress, const Detect& detect) {
  const int count = static_cast<int>(frames.size());
  std::vector<std::optional<Result<T>>> results(frames.size());
  ParallelFor(
      count,
      [&](int i) {
        const auto index = static_cast<std::size_t>(i);
        results[index].emplace(detect(frames[index]));
      },
      [&](int done) {
        if (progress) progress(stage, done, count);
      });
  std::vector<T> found;
  for (auto& result : results) {
    MAPLOC_RETURN_IF_ERROR(result->status());
    found.push_back(std::move(*result).value());
  }
  return found;
}

FrameLines Undistort(const KeyFrame& frame, const LineFeatures& features) {
  FrameLines lines;
  lines.descriptors.kind = features.descriptors.kind;
  for (int i = 0; i < features.size(); ++i) {
    const auto index = static_cast<std::size_t>(i);
    const auto start = frame.camera.Normalize(features.starts_px[index].cast<double>());
    const auto end = frame.camera.Normalize(features.ends_px[index].cast<double>());
    if (!start || !end) continue;
    lines.normalized.push_back({*start, *end});
    const auto row = features.descriptors.row(i);
    lines.descriptors.bytes.insert(lines.descriptors.bytes.end(), row.begin(), row.end());
  }
  return lines;
}

// The slope of the plane that fits the brightness over x, y in [-0.5, 0.5], over its standard
// deviation.
Eigen::Vector2d Brightening(const GrayImage& image) {
  constexpr int kStepPx = 4;  // a gradient over the whole photo needs no detail
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (int y = 0; y < image.height_px; y += kStepPx) {
    for (int x = 0; x < image.width_px; x += kStepPx) {
      const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width_px) +
                         static_cast<std::size_t>(x);
      const double value = image.pixels[index];
      moment += value * Eigen::Vector2d((x + 0.5) / image.width_px - 0.5,
                                        (y + 0.5) / image.height_px - 0.5);
      sum += value;
      squares += value * value;
      ++count;
    }
  }
  const double variance = squares / count - sum * sum / (count * count);
  if (!(variance > 1.0)) return Eigen::Vector2d::Zero();  // one shade: no picture
  return 12.0 * moment / (count * std::sqrt(variance));   // 1/12: the variance of x and of y
}

}  // namespace

Result<std::vector<PointFeatures>> DetectPhotoPoints(const std::string& images_directory,
                                                     std::span<const KeyFrame> frames,
                                                     const DescriptorKind& kind,
                                                     const ProgressFn& progress) {
  return DetectAll<PointFeatures>(
      frames, "detecting keypoints", progress, [&](const KeyFrame& frame) -> Result<PointFeatures> {
        MAPLOC_ASSIGN_OR_RETURN(const GrayImage image, LoadPhoto(images_directory, frame));
        return DetectPoints(image, kind);
      });
}

Result<PhotoLooks> LookAtPhotos(const std::string& images_directory,
                                std::span<const KeyFrame> frames, const ProgressFn& progress) {
  using Look = std::pair<FrameLines, Eigen::Vector2d>;
  MAPLOC_ASSIGN_OR_RETURN(
      std::vector<Look> looks,
      DetectAll<Look>(
          frames, "detecting lines", progress, [&](const KeyFrame& frame) -> Result<Look> {
            MAPLOC_ASSIGN_OR_RETURN(const GrayImage image, LoadPhoto(images_directory, frame));
            MAPLOC_ASSIGN_OR_RETURN(const LineFeatures features, DetectLines(image));
            return Look{Undistort(frame, features), Brightening(image)};
          }));
  PhotoLooks result;
  for (auto& [lines, brightening] : looks) {
    result.lines.push_back(std::move(lines));
    result.brightening.push_back(brightening);
  }
  return result;
}

}  // namespace maploc
