// A request with every field set and valid, for tests that spoil one field each.
#pragma once

#include "maploc/v1/localization_service.pb.h"

namespace maploc::testing {

inline void AddFeatures(std::initializer_list<float> coordinates, const std::string& kind,
                        int bytes_count, int count, v1::Features* features) {
  for (const float value : coordinates) features->add_coordinates_pixels(value);
  features->set_descriptors(std::string(static_cast<std::size_t>(bytes_count) * count, '\x5a'));
  features->mutable_descriptor_kind()->set_name(kind);
  features->mutable_descriptor_kind()->set_bytes_count(bytes_count);
  features->mutable_descriptor_kind()->set_metric(v1::DESCRIPTOR_METRIC_HAMMING);
}

// Three keypoints of "orb", two lines of "lbd".
inline v1::LocalizeRequest ValidRequest() {
  v1::LocalizeRequest request;
  request.set_session_id("0123456789abcdef");
  request.set_map("yard");
  request.set_request_id("frame-17");
  request.set_map_version(3);
  request.set_capture_unix_nanos(1'700'000'000'000'000'000);
  v1::View* view = request.add_views();
  view->mutable_camera()->set_model(v1::CAMERA_MODEL_OPENCV);
  view->mutable_camera()->set_width_pixels(640);
  view->mutable_camera()->set_height_pixels(480);
  for (const double param : {500.0, 501.0, 319.5, 239.5, 0.1, -0.02, 0.001, -0.001}) {
    view->mutable_camera()->add_params(param);
  }
  v1::Rigid3* camera_from_body = view->mutable_camera_from_body();
  camera_from_body->mutable_rotation()->set_x(0.6);
  camera_from_body->mutable_rotation()->set_w(0.8);
  camera_from_body->mutable_translation()->set_z(0.25);
  AddFeatures({1, 2, 3.5, 4.25, 639, 479}, "orb", 32, 3, view->mutable_points());
  AddFeatures({10, 20, 30, 40, 50, 60, 70, 80}, "lbd", 32, 2, view->mutable_lines());
  request.mutable_gravity()->mutable_direction_in_body()->set_y(9.81);
  request.mutable_gravity()->set_sigma_radians(0.01);
  request.mutable_prior()->mutable_position_in_map()->set_x(3);
  request.mutable_prior()->set_position_sigma(2);
  request.set_strategy(v1::STRATEGY_2P);
  request.set_refinement(v1::REFINEMENT_MODE_4DOF);
  request.set_include_matches(true);
  request.set_max_error_pixels(6.5);
  return request;
}

}  // namespace maploc::testing
