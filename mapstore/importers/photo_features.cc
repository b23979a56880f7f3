#include "mapstore/importers/photo_features.h"

#include <cmath>
#include <optional>
#include <utility>

#include "mapstore/base/path_kind.h"

namespace maploc {
namespace {

Result<GrayImage> LoadPhoto(const std::string& images_directory, const KeyFrame& frame) {
  const std::string path = images_directory + "/" + frame.name;
  if (!IsRegularFile(path)) {
    return InvalidFile(path,
                       "is not there, or may not be read; --images is the folder that the model's "
                       "names start from");
  }
  MAPLOC_ASSIGN_OR_RETURN(GrayImage image, LoadGrayImage(path));
  if (image.width_px != frame.camera.width_px() || image.height_px != frame.camera.height_px()) {
    return InvalidFile(path, "is " + std::to_string(image.width_px) + "x" +
                                 std::to_string(image.height_px) + " pixels, but its camera has " +
                                 std::to_string(frame.camera.width_px()) + "x" +
                                 std::to_string(frame.camera.height_px()) +
                                 "; give the photos that the model was made of, in their size");
  }
  return image;
}

// detect(frame) for every frame; the first frame's error, if any. Of a truncated photo `nothing`
// was detected, and its name goes to `truncated`.
template <typename T, typename Detect>
Result<std::vector<T>> DetectAll(std::span<const KeyFrame> frames, std::string_view stage,
                                 const ProgressFn& progress, const T& nothing,
                                 std::vector<std::string>& truncated, const Detect& detect) {
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
  // In the order of the frames, so that the same error is told on every run.
  for (std::size_t i = 0; i < results.size(); ++i) {
    Result<T>& result = *results[i];
    if (result.status().reason() == kTruncatedImage) {
      truncated.push_back(frames[i].name);
      found.push_back(nothing);
      continue;
    }
    MAPLOC_RETURN_IF_ERROR(result.status());
    found.push_back(std::move(result).value());
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

Result<PhotoPoints> DetectPhotoPoints(const std::string& images_directory,
                                      std::span<const KeyFrame> frames, const DescriptorKind& kind,
                                      const ProgressFn& progress) {
  PhotoPoints points;
  PointFeatures nothing;
  nothing.descriptors.kind = kind;
  MAPLOC_ASSIGN_OR_RETURN(
      points.features, DetectAll(frames, "detecting keypoints", progress, nothing, points.truncated,
                                 [&](const KeyFrame& frame) -> Result<PointFeatures> {
                                   MAPLOC_ASSIGN_OR_RETURN(const GrayImage image,
                                                           LoadPhoto(images_directory, frame));
                                   return DetectPoints(image, kind);
                                 }));
  return points;
}

Result<PhotoLooks> LookAtPhotos(const std::string& images_directory,
                                std::span<const KeyFrame> frames, const ProgressFn& progress) {
  using Look = std::pair<FrameLines, Eigen::Vector2d>;
  PhotoLooks result;
  Look nothing{{}, Eigen::Vector2d::Zero()};
  MAPLOC_ASSIGN_OR_RETURN(nothing.first.descriptors.kind, DescriptorKindFromName("lbd"));
  MAPLOC_ASSIGN_OR_RETURN(std::vector<Look> looks,
                          DetectAll(frames, "detecting lines", progress, nothing, result.truncated,
                                    [&](const KeyFrame& frame) -> Result<Look> {
                                      MAPLOC_ASSIGN_OR_RETURN(const GrayImage image,
                                                              LoadPhoto(images_directory, frame));
                                      MAPLOC_ASSIGN_OR_RETURN(const LineFeatures features,
                                                              DetectLines(image));
                                      return Look{Undistort(frame, features), Brightening(image)};
                                    }));
  for (auto& [lines, brightening] : looks) {
    result.lines.push_back(std::move(lines));
    result.brightening.push_back(brightening);
  }
  return result;
}

std::string DescribeTruncated(const std::set<std::string>& names, std::size_t photo_count) {
  constexpr std::size_t kNamed = 3;
  std::string text = std::to_string(names.size()) + " of " + std::to_string(photo_count) +
                     " photos are truncated and were left out: ";
  std::size_t named = 0;
  for (const std::string& name : names) {
    if (named == kNamed) break;
    text += (named++ == 0 ? "" : ", ") + name;
  }
  if (names.size() > named) text += " and " + std::to_string(names.size() - named) + " more";
  return text + "; copy them again and repeat the import";
}

}  // namespace maploc
