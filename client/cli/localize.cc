#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "client/api/client.h"
#include "client/cli/commands.h"
#include "client/cli/draw.h"
#include "client/cli/output.h"
#include "client/cli/recording_flags.h"
#include "client/robot/camera_file.h"
#include "mapstore/base/angles.h"
#include "mapstore/base/table.h"
#include "mapstore/features/features.h"
#include "mapstore/features/photo_header.h"
#include "mapstore/geometry/gravity_reading.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kExample[] =
    "  maploc localize --server 127.0.0.1:50051 --map yard --image photo.jpg --camera cameras.txt "
    "\\\n"
    "      --gravity 0,1,0 --draw answer.png";

struct LocalizeFlags {
  std::string map;
  std::string image;
  std::string camera;
  std::optional<std::int64_t> camera_id;
  std::vector<double> gravity;
  double gravity_sigma_deg = 1.0;
  MethodFlags method;
  std::string draw;
};

// Left out, gravity was not measured.
Result<std::optional<Gravity>> ParseGravity(const LocalizeFlags& flags) {
  if (flags.gravity.empty()) return std::optional<Gravity>();
  MAPLOC_ASSIGN_OR_RETURN(
      const Eigen::Vector3d down,
      DownFromReading("--gravity", {flags.gravity[0], flags.gravity[1], flags.gravity[2]}));
  MAPLOC_RETURN_IF_ERROR(CheckGravitySigmaDeg("--gravity-sigma-deg", flags.gravity_sigma_deg));
  return std::optional(Gravity{down, flags.gravity_sigma_deg * std::numbers::pi / 180.0});
}

struct Photo {
  GrayImage image;
  Camera camera;
};

Result<Photo> ReadPhoto(const LocalizeFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(Camera camera,
                          ReadCameraFile({flags.camera, flags.image, flags.camera_id}));
  MAPLOC_ASSIGN_OR_RETURN(GrayImage image, LoadGrayImage(flags.image));
  MAPLOC_RETURN_IF_ERROR(
      CheckPhotoSize(flags.image, image.width_px, image.height_px, camera, flags.camera));
  return Photo{std::move(image), std::move(camera)};
}

Result<View> ExtractView(const Photo& photo, const MapInfo& map) {
  View view{photo.camera, Rigid3{}, {}, {}};
  if (!map.point_descriptor.name.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(view.points, DetectPoints(photo.image, map.point_descriptor));
  }
  if (!map.line_descriptor.name.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(view.lines, DetectLines(photo.image));
  }
  return view;
}

void TellAboutPhoto(const std::string& path, const Camera& camera) {
  const PixelSize size{camera.width_px(), camera.height_px()};
  for (const std::string& note : {OrientationNote(path), DescribeReduced({&size, 1})}) {
    if (!note.empty()) PrintNotes({note});
  }
}

Json CountsJson(const FeatureCounts& counts) {
  return {{"matches", counts.matches}, {"inliers", counts.inliers}};
}

Json PoseJson(const Localization& answer) {
  if (!answer.map_from_body) return {};
  const Eigen::Vector3d& t = answer.map_from_body->translation;
  const Eigen::Quaterniond& q = answer.map_from_body->rotation;
  Json covariance = Json::array();
  for (int i = 0; i < 36; ++i) covariance.push_back(answer.covariance(i / 6, i % 6));
  return {{"translation", {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},
          {"rotation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}},
          {"covariance", std::move(covariance)}};
}

// Gravity was sent, and a pose of the matches alone is there.
bool WasCompared(const Evidence& evidence) { return evidence.gravity_disagreement_rad != 0.0; }

Json AnswerJson(const Localization& answer) {
  const Evidence& evidence = answer.evidence;
  const std::optional<FocalScale>& focal = evidence.focal_scale;
  return {{"outcome", OutcomeName(answer.outcome)},
          {"map_from_body", PoseJson(answer)},
          {"segment", answer.segment},
          {"strategy", StrategyName(evidence.strategy)},
          {"iterations", evidence.iterations},
          {"points", CountsJson(evidence.points)},
          {"usable_lines", CountsJson(evidence.usable_lines)},
          {"vertical_lines", CountsJson(evidence.vertical_lines)},
          {"confidence", evidence.confidence},
          {"gravity_disagreement_rad",
           WasCompared(evidence) ? Json(evidence.gravity_disagreement_rad) : Json()},
          {"gravity_rejected", evidence.gravity_rejected},
          {"inlier_rms_px", evidence.inlier_rms_px},
          {"focal_length_scale", focal ? Json(focal->scale) : Json()},
          {"focal_length_scale_sigma", focal ? Json(focal->sigma) : Json()},
          {"server_ms", answer.times.total_ms}};
}

std::string GravityText(const Localization& answer) {
  const Evidence& evidence = answer.evidence;
  if (!WasCompared(evidence)) return "not compared";
  const bool contradicts =
      evidence.gravity_rejected || answer.outcome == Outcome::kGravityInconsistent;
  return FormatNumber(evidence.gravity_disagreement_rad * kDegPerRad, 2) +
         " deg from the matches'" + (contradicts ? ": contradicts them" : "") +
         (evidence.gravity_rejected ? ", and was not used" : "");
}

std::string FocalLengthText(const Localization& answer) {
  const bool contradicts = answer.outcome == Outcome::kCalibrationInconsistent;
  const std::string verdict =
      contradicts ? "; another lens (focal length, centre, distortion) explains more of the "
                    "matches than the one sent: calibrate again, or check --camera"
                  : "";
  const std::optional<FocalScale>& focal = answer.evidence.focal_scale;
  if (!focal) return "not determined by the matches" + verdict;
  return FormatNumber(focal->scale, 4) + " of the sent one, by the matches (sigma " +
         FormatNumber(focal->sigma, 4) + ")" + verdict;
}

// Of a pose that was found and not trusted: a confidence near 1 would be a riddle without it.
std::string DoubtText(const Evidence& evidence) {
  const auto sum = [&evidence](std::int32_t FeatureCounts::*count) {
    return evidence.points.*count + evidence.usable_lines.*count + evidence.vertical_lines.*count;
  };
  return std::to_string(sum(&FeatureCounts::inliers)) + " of " +
         std::to_string(sum(&FeatureCounts::matches)) + " matches agree on a pose (rms " +
         FormatNumber(evidence.inlier_rms_px, 2) +
         " px), but they may do so by chance, leave the pose undetermined, or fit another pose as "
         "well";
}

void PrintAnswer(const MapInfo& map, const Localization& answer, std::ostream& out) {
  const Evidence& evidence = answer.evidence;
  out << OutcomeName(answer.outcome) << " in map " << map.key.name << ", segment " << answer.segment
      << " (" << StrategyName(evidence.strategy) << ", " << evidence.iterations << " iterations, "
      << FormatNumber(answer.times.total_ms, 1) << " ms)\n";
  if (answer.outcome == Outcome::kLowConfidence) {
    out << "not trusted  " << DoubtText(evidence) << "\n";
  }
  if (answer.map_from_body) {
    const Rigid3& pose = *answer.map_from_body;
    const auto sigma = answer.covariance.diagonal().cwiseSqrt();
    out << "position     " << pose.translation.transpose() << (map.metric ? " m" : " map units")
        << " (sigma " << sigma.head<3>().transpose() << ")\n"
        << "orientation  " << pose.rotation.coeffs().transpose() << " (x y z w, sigma "
        << sigma.tail<3>().transpose() * kDegPerRad << " deg)\n";
  }
  Table table({"", "inliers", "matches"});
  const auto row = [&table](const char* name, const FeatureCounts& counts) {
    table.AddRow({name, std::to_string(counts.inliers), std::to_string(counts.matches)});
  };
  row("points", evidence.points);
  row("usable lines", evidence.usable_lines);
  row("vertical lines", evidence.vertical_lines);
  table.Print(out);
  out << "confidence   " << FormatNumber(evidence.confidence, 4) << "\n"
      << "inlier rms   "
      << FormatNumber(
             evidence.inlier_rms_px > 0.0 ? std::optional(evidence.inlier_rms_px) : std::nullopt, 2)
      << " px\n"
      << "gravity      " << GravityText(answer) << "\n"
      << "focal length " << FocalLengthText(answer) << "\n";
}

Status Run(const CommandContext& context, const LocalizeFlags& flags) {
  Query query;
  MAPLOC_ASSIGN_OR_RETURN(query.gravity, ParseGravity(flags));
  // Before the server is asked: a misspelt file must not be hidden by a server that cannot be
  // reached.
  MAPLOC_ASSIGN_OR_RETURN(const Photo photo, ReadPhoto(flags));
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  MAPLOC_ASSIGN_OR_RETURN(const RemoteMap map, client.GetMap(flags.map));
  MAPLOC_ASSIGN_OR_RETURN(View view, ExtractView(photo, map.info));
  TellAboutPhoto(flags.image, view.camera);
  query.map = flags.map;
  query.views.push_back(std::move(view));
  query.requested_strategy = flags.method.RequestedStrategy();
  query.refinement = flags.method.RequestedRefinement();
  query.max_error_px = flags.method.max_error_px;
  MAPLOC_ASSIGN_OR_RETURN(const Localization answer, client.Localize(query, !flags.draw.empty()));
  // Before the picture: one that cannot be written must not lose the answer.
  context.json ? PrintJson(AnswerJson(answer)) : PrintAnswer(map.info, answer, std::cout);
  if (flags.draw.empty()) return Status::Ok();
  return DrawLocalization(flags.image, query.views[0], answer, flags.draw);
}

}  // namespace

void AddLocalizeCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<LocalizeFlags>();
  CLI::App* command = AddCommand(
      app, context, "localize",
      "Localize one photo in a map; reports its pose, its evidence, and whether the matches "
      "agree with the gravity and the focal length that were sent",
      kExample, [&context, flags] { return Run(context, *flags); });
  AddServerFlag(*command, context)->required();
  command->add_option("--map", flags->map, "the map's name")->required();
  command->add_option("--image", flags->image, "the photo")->required();
  command
      ->add_option("--camera", flags->camera,
                   "its calibration, of the pixels as stored: COLMAP's cameras.txt (of several the "
                   "one that images.txt beside it gives the photo), a model's folder, or an EuRoC "
                   "sensor.yaml")
      ->required();
  command->add_option("--camera-id", flags->camera_id, "which of several cameras took the photo");
  command
      ->add_option("--gravity", flags->gravity,
                   "X,Y,Z: down, in the frame of the stored pixels' camera, unit or in m/s^2; left "
                   "out: not measured")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--gravity-sigma-deg", flags->gravity_sigma_deg,
                   "its standard deviation, above 0 and at most 90")
      ->capture_default_str();
  AddMethodFlags(*command, flags->method);
  command->add_option("--draw", flags->draw,
                      "write the photo with its matches and inliers: a .png, .jpg, .bmp or .tif");
}

}  // namespace maploc
