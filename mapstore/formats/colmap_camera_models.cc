#include "mapstore/formats/colmap_camera_models.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "mapstore/formats/text_fields.h"

namespace maploc {
namespace {

struct ModelTraits {
  std::string_view name;
  int param_count;
  bool two_focal_lengths;
  std::optional<CameraModel> as;  // what maploc computes it with
};

// By COLMAP's number (src/colmap/sensor/models.h). A fisheye's coefficients are the first ones of
// OPENCV_FISHEYE's polynomial.
constexpr std::array<ModelTraits, 18> kModels = {{
    {"SIMPLE_PINHOLE", 3, false, CameraModel::kSimplePinhole},
    {"PINHOLE", 4, true, CameraModel::kPinhole},
    {"SIMPLE_RADIAL", 4, false, CameraModel::kSimpleRadial},
    {"RADIAL", 5, false, CameraModel::kRadial},
    {"OPENCV", 8, true, CameraModel::kOpenCv},
    {"OPENCV_FISHEYE", 8, true, CameraModel::kOpenCvFisheye},
    {"FULL_OPENCV", 12, true, std::nullopt},
    {"FOV", 5, true, std::nullopt},
    {"SIMPLE_RADIAL_FISHEYE", 4, false, CameraModel::kOpenCvFisheye},
    {"RADIAL_FISHEYE", 5, false, CameraModel::kOpenCvFisheye},
    {"THIN_PRISM_FISHEYE", 12, true, std::nullopt},
    {"RAD_TAN_THIN_PRISM_FISHEYE", 16, true, std::nullopt},
    {"SIMPLE_DIVISION", 4, false, std::nullopt},
    {"DIVISION", 5, true, std::nullopt},
    {"SIMPLE_FISHEYE", 3, false, CameraModel::kOpenCvFisheye},
    {"FISHEYE", 4, true, CameraModel::kOpenCvFisheye},
    {"EUCM", 6, true, std::nullopt},
    {"EQUIRECTANGULAR", 2, false, std::nullopt},
}};

constexpr std::string_view kUndistort =
    " is not supported; undistort the photos with `colmap image_undistorter` and use the model and "
    "the photos that it writes";
constexpr std::string_view kCutPanorama =
    " is not supported: a panorama has no image plane; cut the photos into perspective views and "
    "reconstruct those";
constexpr std::string_view kUnknown =
    " is no camera model of COLMAP 4; supported are SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, "
    "RADIAL, OPENCV and all fisheyes without tangential or prism terms";

const ModelTraits* FindTraits(std::string_view name) {
  const auto* found = std::find_if(kModels.begin(), kModels.end(),
                                   [&](const ModelTraits& model) { return model.name == name; });
  return found == kModels.end() ? nullptr : found;
}

Status Unsupported(std::string_view name, const ModelTraits* traits) {
  std::string_view why = kUndistort;
  if (traits == nullptr) why = kUnknown;
  if (name == "EQUIRECTANGULAR") why = kCutPanorama;
  return InvalidArgument("camera model", Quoted(name) + std::string(why), kUnsupportedCameraModel);
}

// f, cx, cy, k.. or fx, fy, cx, cy, k.. as fx, fy, cx, cy, k1, k2, k3, k4.
std::vector<double> FillFisheye(const ModelTraits& traits, std::vector<double> params) {
  if (!traits.two_focal_lengths) params.insert(params.begin(), params.front());
  params.resize(static_cast<std::size_t>(CameraParamCount(CameraModel::kOpenCvFisheye)), 0.0);
  return params;
}

}  // namespace

std::string_view ColmapModelName(std::int64_t model_id) {
  if (model_id < 0 || model_id >= static_cast<std::int64_t>(kModels.size())) return "";
  return kModels[static_cast<std::size_t>(model_id)].name;
}

int ColmapParamCount(std::int64_t model_id) {
  return kModels[static_cast<std::size_t>(model_id)].param_count;
}

Result<Camera> MakeColmapCamera(std::string_view model_name, std::int64_t width_px,
                                std::int64_t height_px, std::vector<double> params) {
  const ModelTraits* traits = FindTraits(model_name);
  if (traits == nullptr) return Unsupported(model_name, traits);
  if (static_cast<int>(params.size()) != traits->param_count) {
    return InvalidArgument("camera parameters", std::string(traits->name) + " takes " +
                                                    std::to_string(traits->param_count) +
                                                    " parameters, got " +
                                                    std::to_string(params.size()));
  }
  if (!traits->as) return Unsupported(model_name, traits);
  if (width_px < 1 || width_px > kMaxImageSidePx || height_px < 1 || height_px > kMaxImageSidePx) {
    return InvalidArgument("camera size", "sides must be in [1, 65536] pixels");
  }
  // COLMAP has the centre of the first pixel at (0.5, 0.5), maploc at (0, 0).
  const std::size_t cx = traits->two_focal_lengths ? 2 : 1;
  params[cx] -= 0.5;
  params[cx + 1] -= 0.5;
  if (*traits->as == CameraModel::kOpenCvFisheye) params = FillFisheye(*traits, std::move(params));
  return Camera::Create(*traits->as, static_cast<int>(width_px), static_cast<int>(height_px),
                        std::move(params));
}

}  // namespace maploc
