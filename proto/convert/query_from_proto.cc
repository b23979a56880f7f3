#include <cmath>
#include <numbers>

#include "maploc/v1/localization_service.pb.h"
#include "mapstore/base/name.h"
#include "proto/convert/camera.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"
#include "proto/convert/features.h"

namespace maploc {
namespace {

Result<View> ViewFromProto(const v1::View& view, const std::string& field) {
  if (!view.has_camera()) return InvalidArgument(field + ".camera", "is required", "REQUIRED");
  MAPLOC_ASSIGN_OR_RETURN(Camera camera,
                          convert::CameraFromProto(view.camera(), field + ".camera"));
  View result{.camera = std::move(camera), .camera_from_body = {}, .points = {}, .lines = {}};
  // The only transform with a default: the contract says that the body is the camera where it is
  // unset.
  if (view.has_camera_from_body()) {
    MAPLOC_ASSIGN_OR_RETURN(result.camera_from_body,
                            Rigid3FromProto(view.camera_from_body(), field + ".camera_from_body"));
  }
  MAPLOC_ASSIGN_OR_RETURN(result.points,
                          convert::PointFeaturesFromProto(view.points(), field + ".points"));
  MAPLOC_ASSIGN_OR_RETURN(result.lines,
                          convert::LineFeaturesFromProto(view.lines(), field + ".lines"));
  return result;
}

// Unset is absent; whatever is sent must be a direction.
Result<std::optional<Gravity>> GravityFromProto(const v1::LocalizeRequest& request) {
  if (!request.has_gravity()) return std::optional<Gravity>();
  const std::string field = "gravity.direction_in_body";
  const v1::Gravity& gravity = request.gravity();
  MAPLOC_ASSIGN_OR_RETURN(const Eigen::Vector3d direction,
                          convert::VectorFromProto(gravity.direction_in_body(), field));
  // Anything shorter is a sensor that never reported, not a direction in any unit.
  constexpr double kMinNorm = 1e-6;
  if (!(direction.norm() >= kMinNorm)) {
    return InvalidArgument(field, "is zero; send the direction down in the body frame",
                           "ZERO_GRAVITY");
  }
  const double sigma_rad = gravity.sigma_radians();
  // Negated here and below, so that a NaN is refused too.
  if (!(sigma_rad > 0 && sigma_rad <= std::numbers::pi / 2)) {
    return InvalidArgument("gravity.sigma_radians", "must be in (0, pi/2] radians", "OUT_OF_RANGE");
  }
  return std::optional(Gravity{direction.normalized(), sigma_rad});
}

Result<PosePrior> PriorFromProto(const v1::PosePrior& prior) {
  PosePrior result;
  // proto3 reads an unset message as zeros, and the prior would be taken for one at the origin of
  // the map.
  if (!prior.has_position_in_map()) {
    return InvalidArgument("prior.position_in_map", "is required in a prior", "REQUIRED");
  }
  MAPLOC_ASSIGN_OR_RETURN(
      result.position_in_map,
      convert::VectorFromProto(prior.position_in_map(), "prior.position_in_map"));
  result.sigma_m = prior.position_sigma();
  if (!(result.sigma_m > 0 && result.sigma_m <= convert::kMaxPosition)) {
    return InvalidArgument("prior.position_sigma", "must be positive and at most 1e9",
                           "OUT_OF_RANGE");
  }
  return result;
}

Result<Refinement> RefinementFromProto(v1::RefinementMode mode) {
  switch (mode) {
    case v1::REFINEMENT_MODE_UNSPECIFIED:
    case v1::REFINEMENT_MODE_AUTO:
      return Refinement::kAuto;
    case v1::REFINEMENT_MODE_4DOF:
      return Refinement::k4Dof;
    case v1::REFINEMENT_MODE_6DOF:
      return Refinement::k6Dof;
    default:
      return convert::UnknownEnum("refinement", mode);
  }
}

Result<std::optional<double>> MaxErrorFromProto(const v1::LocalizeRequest& request) {
  if (!request.has_max_error_pixels()) return std::optional<double>();
  const double max_error_px = request.max_error_pixels();
  if (!(max_error_px >= 0.1 && max_error_px <= 1000.0)) {
    return InvalidArgument("max_error_pixels", "must be in [0.1, 1000]", "OUT_OF_RANGE");
  }
  return std::optional(max_error_px);
}

Status CheckNames(const v1::LocalizeRequest& request) {
  MAPLOC_RETURN_IF_ERROR(CheckName("session_id", request.session_id()));
  MAPLOC_RETURN_IF_ERROR(CheckName("map", request.map()));
  MAPLOC_RETURN_IF_ERROR(CheckName("request_id", request.request_id()));
  // Within a session the map may be left out. That one which is sent is the session's is checked
  // where sessions are known (server/service/localize.cc).
  if (request.session_id().empty() && request.map().empty()) {
    return InvalidArgument("map", "is required outside of a session", "REQUIRED");
  }
  MAPLOC_RETURN_IF_ERROR(convert::CheckMapVersion(request.map_version()));
  if (request.capture_unix_nanos() < 0) {
    return InvalidArgument("capture_unix_nanos", "must not be negative", "OUT_OF_RANGE");
  }
  return Status::Ok();
}

Status CheckViewCount(int count) {
  if (count == 0) return InvalidArgument("views", "one view is required", "REQUIRED");
  if (count == 1) return Status::Ok();
  return InvalidArgument("views",
                         "this server takes exactly one view a query, got " + std::to_string(count),
                         "TOO_MANY_VIEWS");
}

}  // namespace

Result<Query> QueryFromProto(const v1::LocalizeRequest& request) {
  MAPLOC_RETURN_IF_ERROR(CheckNames(request));
  MAPLOC_RETURN_IF_ERROR(CheckViewCount(request.views_size()));
  Query query;
  query.request_id = request.request_id();
  query.session = request.session_id();
  query.map = request.map();
  query.map_version = request.map_version();
  query.capture_unix_ns = request.capture_unix_nanos();
  MAPLOC_ASSIGN_OR_RETURN(query.gravity, GravityFromProto(request));
  if (request.has_prior()) {
    MAPLOC_ASSIGN_OR_RETURN(query.prior, PriorFromProto(request.prior()));
  }
  if (request.strategy() != v1::STRATEGY_UNSPECIFIED) {
    MAPLOC_ASSIGN_OR_RETURN(query.requested_strategy,
                            convert::StrategyFromProto(request.strategy(), "strategy"));
  }
  MAPLOC_ASSIGN_OR_RETURN(query.refinement, RefinementFromProto(request.refinement()));
  MAPLOC_ASSIGN_OR_RETURN(query.max_error_px, MaxErrorFromProto(request));
  // Last, because it is the largest part: a request that is refused for another field is not
  // copied.
  MAPLOC_ASSIGN_OR_RETURN(View view, ViewFromProto(request.views(0), "views[0]"));
  query.views.push_back(std::move(view));
  return query;
}

}  // namespace maploc
