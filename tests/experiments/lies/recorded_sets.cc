#include "tests/experiments/lies/recorded_sets.h"

#include <algorithm>
#include <filesystem>

#include "client/robot/recorded_robot.h"
#include "mapstore/base/median.h"
#include "tests/experiments/selection/selection_set.h"

namespace maploc::lies {
namespace {

struct SetDescription {
  const char* name;
  std::vector<std::string> sessions;
  Eigen::Vector3d gravity_in_source;
  bool metric;
};

const std::vector<SetDescription>& Descriptions() {
  static const std::vector<SetDescription> sets = {
      {"herzjesu", {"query"}, {0, 0, 1}, true},
      {"euroc_v101", {"session_1", "session_2", "session_3", "session_4"}, {0, 0, -1}, true},
      {"sacre_coeur", {"night"}, {0.0149, 0.7984, -0.6019}, false},
      {"reichstag", {"dusk", "day"}, {-0.006, 0.988, -0.155}, false},
  };
  return sets;
}

std::string IfThere(const std::string& path) { return std::filesystem::exists(path) ? path : ""; }

// Of the landmarks that the reference sees in the picture.
double MedianDepth(const MapSnapshot& map, const Camera& camera, const Rigid3& camera_from_map) {
  std::vector<double> depths;
  for (SegmentId id = 0; id < map.places->segment_count(); ++id) {
    const MapSnapshot::Entry entry = map.Load(id, {}).value();  // it is in memory
    for (const Eigen::Vector3d& position : entry.segment->points.positions_in_map) {
      const Eigen::Vector3d in_camera = camera_from_map * position;
      const auto pixel = camera.Project(in_camera);
      if (!pixel || (pixel->array() < 0).any()) continue;
      if (pixel->x() > camera.width_px() || pixel->y() > camera.height_px()) continue;
      depths.push_back(in_camera.z());
    }
  }
  return depths.empty() ? 0.0 : UpperMedian(std::move(depths));
}

RecordingOptions Recording(const std::string& folder, const std::string& session,
                           std::uint64_t seed) {
  RecordingOptions recording;
  recording.model_dir = folder + "/" + session;
  recording.database = folder + "/database.db";
  recording.images = IfThere(folder + "/images");
  recording.gravity.csv = IfThere(folder + "/gravity.csv");
  if (recording.gravity.csv.empty()) recording.gravity.noise_deg = 0.5;
  recording.gravity.seed = seed;
  return recording;
}

Result<std::shared_ptr<const MapSnapshot>> Import(const SetDescription& set,
                                                  const std::string& folder) {
  ColmapImportOptions options;
  options.map_name = set.name;
  options.model_directory = folder + "/map";
  options.database_path = folder + "/database.db";
  options.images_directory = IfThere(folder + "/images");
  options.gravity_in_source = set.gravity_in_source;
  if (set.metric) options.meters_per_unit = 1.0;
  return selection::ImportMap(options);
}

}  // namespace

std::vector<std::string> SetNames() {
  std::vector<std::string> names;
  for (const SetDescription& set : Descriptions()) names.push_back(set.name);
  return names;
}

Result<LoadedSet> LoadSet(const std::string& name, const std::string& data_folder,
                          std::uint64_t seed) {
  const SetDescription& set = *std::ranges::find(Descriptions(), name, &SetDescription::name);
  const std::string folder = data_folder + "/" + name;
  LoadedSet loaded{name, set.metric, nullptr, {}};
  MAPLOC_ASSIGN_OR_RETURN(loaded.map, Import(set, folder));
  for (const std::string& session : set.sessions) {
    MAPLOC_ASSIGN_OR_RETURN(
        const RecordedRobot robot,
        RecordedRobot::Open(Recording(folder, session, seed), loaded.map->info));
    for (int i = 0; i < robot.QueryCount(); ++i) {
      HonestQuery honest;
      honest.name = robot.QueryName(i);
      MAPLOC_ASSIGN_OR_RETURN(honest.query, robot.MakeQuery(i));
      honest.map_from_camera = robot.ReferenceMapFromBody(i);
      honest.median_depth =
          MedianDepth(*loaded.map, honest.query.views[0].camera, honest.map_from_camera.Inverse());
      honest.photo = robot.ImagePath(i);
      loaded.queries.push_back(std::move(honest));
    }
  }
  return loaded;
}

}  // namespace maploc::lies
