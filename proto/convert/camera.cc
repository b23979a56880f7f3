#include "proto/convert/camera.h"

#include <cmath>
#include <utility>

#include "proto/convert/checks.h"

namespace maploc::convert {
namespace {

// The wire counts COLMAP's models from 1: 0 must stay "unset".
constexpr int kWireOffset = 1;

Status CheckSide(const std::string& field, int side_px) {
  if (side_px >= 1 && side_px <= kMaxImageSidePx) return Status::Ok();
  return InvalidArgument(field, "must be in [1, 65536]", "OUT_OF_RANGE");
}

// `params` begins with `focal_count` focal lengths, then the principal point, then the distortion.
Status CheckParam(const std::string& field, double value, int index, int focal_count) {
  if (!std::isfinite(value)) return InvalidArgument(field, "must be finite", "NOT_FINITE");
  if (index < focal_count) {
    if (value >= kMinFocalLengthPx && value <= kMaxFocalLengthPx) return Status::Ok();
    return InvalidArgument(field, "the focal length must be in [0.1, 1e7] pixels",
                           "BAD_FOCAL_LENGTH");
  }
  if (std::abs(value) <= kMaxCoordinatePx) return Status::Ok();
  return InvalidArgument(field, "is out of range", "OUT_OF_RANGE");
}

int FocalCount(CameraModel model) {
  const bool two = model == CameraModel::kPinhole || model == CameraModel::kOpenCv ||
                   model == CameraModel::kOpenCvFisheye;
  return two ? 2 : 1;
}

}  // namespace

Result<Camera> CameraFromProto(const v1::Camera& camera, const std::string& field) {
  if (camera.model() < v1::CAMERA_MODEL_SIMPLE_PINHOLE ||
      camera.model() > v1::CAMERA_MODEL_OPENCV_FISHEYE) {
    return UnknownEnum(field + ".model", camera.model());
  }
  MAPLOC_RETURN_IF_ERROR(CheckSide(field + ".width_pixels", camera.width_pixels()));
  MAPLOC_RETURN_IF_ERROR(CheckSide(field + ".height_pixels", camera.height_pixels()));
  const auto model = static_cast<CameraModel>(camera.model() - kWireOffset);
  // Before the loop, which takes the index for the meaning of a parameter.
  if (camera.params_size() != CameraParamCount(model)) {
    return InvalidArgument(field + ".params",
                           std::string(CameraModelName(model)) + " takes " +
                               std::to_string(CameraParamCount(model)) + " parameters, got " +
                               std::to_string(camera.params_size()),
                           "COUNT_MISMATCH");
  }
  for (int i = 0; i < camera.params_size(); ++i) {
    MAPLOC_RETURN_IF_ERROR(
        CheckParam(At(field + ".params", i), camera.params(i), i, FocalCount(model)));
  }
  return Camera::Create(model, camera.width_pixels(), camera.height_pixels(),
                        {camera.params().begin(), camera.params().end()}, field);
}

void CameraToProto(const Camera& camera, v1::Camera* proto) {
  proto->set_model(static_cast<v1::CameraModel>(static_cast<int>(camera.model()) + kWireOffset));
  proto->set_width_pixels(camera.width_px());
  proto->set_height_pixels(camera.height_px());
  proto->mutable_params()->Assign(camera.params().begin(), camera.params().end());
}

}  // namespace maploc::convert
