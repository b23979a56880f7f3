#include "maploc/v1/localization_service.pb.h"
#include "proto/convert/camera.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"
#include "proto/convert/features.h"

namespace maploc {
namespace {

void ViewToProto(const View& view, v1::View* proto) {
  convert::CameraToProto(view.camera, proto->mutable_camera());
  Rigid3ToProto(view.camera_from_body, proto->mutable_camera_from_body());
  convert::PointFeaturesToProto(view.points, proto->mutable_points());
  convert::LineFeaturesToProto(view.lines, proto->mutable_lines());
}

}  // namespace

void QueryToProto(const Query& query, bool include_matches, v1::LocalizeRequest* request) {
  request->Clear();
  request->set_session_id(query.session);
  request->set_map(query.map);
  request->set_map_version(query.map_version);
  request->set_request_id(query.request_id);
  request->set_capture_unix_nanos(query.capture_unix_ns);
  for (const View& view : query.views) ViewToProto(view, request->add_views());
  if (query.gravity) {
    v1::Gravity* gravity = request->mutable_gravity();
    convert::VectorToProto(query.gravity->direction_in_body, gravity->mutable_direction_in_body());
    gravity->set_sigma_radians(query.gravity->sigma_rad);
  }
  if (query.prior) {
    v1::PosePrior* prior = request->mutable_prior();
    convert::VectorToProto(query.prior->position_in_map, prior->mutable_position_in_map());
    prior->set_position_sigma(query.prior->sigma_m);
  }
  if (query.requested_strategy) {
    request->set_strategy(convert::StrategyToProto(*query.requested_strategy));
  }
  request->set_refinement(static_cast<v1::RefinementMode>(query.refinement));
  request->set_include_matches(include_matches);
  if (query.max_error_px) request->set_max_error_pixels(*query.max_error_px);
}

}  // namespace maploc
