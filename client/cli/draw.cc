#include "client/cli/draw.h"

#include <filesystem>
#include <fstream>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "mapstore/features/image.h"

namespace maploc {
namespace {

// Blue, green, red.
const cv::Scalar kPointInlier(60, 200, 40);
const cv::Scalar kPointOutlier(60, 60, 230);
const cv::Scalar kLineInlier(255, 140, 20);
const cv::Scalar kLineOutlier(30, 150, 255);
const cv::Scalar kUnmatched(150, 150, 150);

// Subpixel drawing: OpenCV's fixed-point coordinates.
constexpr int kShift = 4;

cv::Point Fixed(const Eigen::Vector2f& pixel) {
  return {cvRound(pixel.x() * (1 << kShift)), cvRound(pixel.y() * (1 << kShift))};
}

void DrawUnmatched(const View& view, cv::Mat& image) {
  for (const Eigen::Vector2f& keypoint : view.points.keypoints_px) {
    cv::circle(image, Fixed(keypoint), 1 << kShift, kUnmatched, 1, cv::LINE_AA, kShift);
  }
  for (int i = 0; i < view.lines.size(); ++i) {
    cv::line(image, Fixed(view.lines.starts_px[i]), Fixed(view.lines.ends_px[i]), kUnmatched, 1,
             cv::LINE_AA, kShift);
  }
}

// Outliers first, so that inliers lie on top.
void DrawMatched(const View& view, const Localization& answer, bool inliers, cv::Mat& image) {
  for (std::size_t i = 0; i < answer.matches.lines.size(); ++i) {
    if ((answer.line_match_inlier[i] != 0) != inliers) continue;
    const int feature = answer.matches.lines[i].feature;
    cv::line(image, Fixed(view.lines.starts_px[feature]), Fixed(view.lines.ends_px[feature]),
             inliers ? kLineInlier : kLineOutlier, 2, cv::LINE_AA, kShift);
  }
  for (std::size_t i = 0; i < answer.matches.points.size(); ++i) {
    if ((answer.point_match_inlier[i] != 0) != inliers) continue;
    const int feature = answer.matches.points[i].feature;
    cv::circle(image, Fixed(view.points.keypoints_px[feature]), 4 << kShift,
               inliers ? kPointInlier : kPointOutlier, 2, cv::LINE_AA, kShift);
  }
}

std::string Counts(const FeatureCounts& counts) {
  return std::to_string(counts.inliers) + "/" + std::to_string(counts.matches);
}

void DrawCaption(const Localization& answer, cv::Mat& image) {
  const Evidence& evidence = answer.evidence;
  const std::string caption = std::string(OutcomeName(answer.outcome)) + "  segment " +
                              std::to_string(answer.segment) + "  " +
                              std::string(StrategyName(evidence.strategy)) + "  points " +
                              Counts(evidence.points) + "  lines " + Counts(evidence.usable_lines) +
                              " + " + Counts(evidence.vertical_lines) + " vertical";
  const double size = std::max(0.4, image.cols / 1600.0);
  const cv::Point at(8, image.rows - 10);
  // White on a wider black, to be read on any photo.
  cv::putText(image, caption, at, cv::FONT_HERSHEY_SIMPLEX, size, {0, 0, 0}, 4, cv::LINE_AA);
  cv::putText(image, caption, at, cv::FONT_HERSHEY_SIMPLEX, size, {255, 255, 255}, 1, cv::LINE_AA);
}

}  // namespace

Status DrawLocalization(const std::string& photo_path, const View& view,
                        const Localization& localization, const std::string& out_path) {
  try {
    // The picture that the features were found in. cv::imread would show 12 bits in 16 nearly
    // black.
    MAPLOC_ASSIGN_OR_RETURN(GrayImage photo, LoadGrayImage(photo_path));
    const cv::Mat grey(photo.height_px, photo.width_px, CV_8UC1, photo.pixels.data());
    cv::Mat image;
    cv::cvtColor(grey, image, cv::COLOR_GRAY2BGR);
    DrawUnmatched(view, image);
    DrawMatched(view, localization, false, image);
    DrawMatched(view, localization, true, image);
    DrawCaption(localization, image);
    const std::string extension = std::filesystem::path(out_path).extension().string();
    // Asked first: for an unknown ending imencode throws, in words of OpenCV that name no cure.
    if (!cv::haveImageWriter("picture" + extension)) {
      return InvalidArgument("--draw", "'" + out_path + "' must end in .png, .jpg, .bmp or .tif");
    }
    // Not imwrite, which does not notice a full disk.
    std::vector<unsigned char> bytes;
    cv::imencode(extension, image, bytes);
    std::ofstream file(out_path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (file && !bytes.empty()) return Status::Ok();
    return InvalidArgument(
        "--draw", "'" + out_path + "' could not be written; check the folder and the disk");
  } catch (const cv::Exception& error) {
    return InvalidArgument("--draw", "'" + out_path + "': " + error.msg);
  }
}

}  // namespace maploc
