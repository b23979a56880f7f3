#include "tests/experiments/selection/recorded_folder.h"

#include <algorithm>
#include <filesystem>

#include "client/robot/recorded_robot.h"
#include "mapstore/formats/colmap.h"

namespace maploc::selection {
namespace {

constexpr char kMapFolder[] = "map";

std::string GravityFile(const std::string& folder) {
  const std::string path = folder + "/gravity.csv";
  return std::filesystem::exists(path) ? path : "";
}

std::vector<std::string> SessionFolders(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const bool is_model = std::filesystem::exists(entry.path() / "images.txt") ||
                          std::filesystem::exists(entry.path() / "images.bin");
    const std::string name = entry.path().filename().string();
    if (is_model && name != kMapFolder) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

// The mean of what the IMU said on the mapping drive, by the reference's rotations.
Result<Eigen::Vector3d> MeasuredGravityInSource(const std::string& model_folder,
                                                const std::string& gravity_file) {
  MAPLOC_ASSIGN_OR_RETURN(const auto measured_in_camera, ReadGravityCsv(gravity_file));
  MAPLOC_ASSIGN_OR_RETURN(const ColmapModel model, ReadColmapModel(model_folder));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [id, image] : model.images) {
    const auto measured = measured_in_camera.find(image.name);
    if (measured == measured_in_camera.end()) continue;
    sum += image.camera_from_source.rotation.conjugate() * measured->second;
  }
  if (sum.norm() == 0.0) return InvalidFile(gravity_file, "names none of the map's images");
  return Eigen::Vector3d(sum.normalized());
}

Result<ColmapImportOptions> ImportOptionsOf(const RecordedFolderOptions& options) {
  ColmapImportOptions import;
  import.map_name = "recorded";
  import.model_directory = options.folder + "/" + kMapFolder;
  import.database_path = options.folder + "/database.db";
  import.meters_per_unit = 1.0;
  import.detect_lines = false;
  import.gravity_in_source = options.gravity_in_source;
  const std::string gravity_file = GravityFile(options.folder);
  if (!import.gravity_in_source && !gravity_file.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(import.gravity_in_source,
                            MeasuredGravityInSource(import.model_directory, gravity_file));
  }
  return import;
}

Result<SetSession> ReadSession(const std::string& name, const RecordedFolderOptions& options,
                               const MapInfo& map) {
  RecordingOptions recording;
  recording.model_dir = options.folder + "/" + name;
  recording.database = options.folder + "/database.db";
  recording.gravity.csv = GravityFile(options.folder);
  if (recording.gravity.csv.empty()) recording.gravity.noise_deg = options.gravity_noise_deg;
  recording.gravity.seed = options.seed;
  MAPLOC_ASSIGN_OR_RETURN(const RecordedRobot robot, RecordedRobot::Open(recording, map));
  SetSession session{name, {}};
  for (int i = 0; i < robot.QueryCount(); ++i) {
    MAPLOC_ASSIGN_OR_RETURN(Query query, robot.MakeQuery(i));
    session.queries.push_back(
        {robot.QueryName(i), std::move(query), robot.ReferenceMapFromBody(i), std::nullopt});
  }
  return session;
}

}  // namespace

Result<SelectionSet> LoadRecordedFolder(const RecordedFolderOptions& options) {
  if (!std::filesystem::is_directory(options.folder)) {
    return InvalidArgument("--set", "'" + options.folder + "' is neither campus nor a folder");
  }
  const std::vector<std::string> names = SessionFolders(options.folder);
  if (names.size() < 2) {
    return FailedPrecondition(
        "TOO_FEW_SESSIONS",
        options.folder + " has " + std::to_string(names.size()) +
            " folders with a session's COLMAP model; one is left out, so it takes two");
  }
  MAPLOC_ASSIGN_OR_RETURN(const ColmapImportOptions import, ImportOptionsOf(options));
  SelectionSet set;
  MAPLOC_ASSIGN_OR_RETURN(set.map, ImportMap(import));
  for (const std::string& name : names) {
    MAPLOC_ASSIGN_OR_RETURN(SetSession session, ReadSession(name, options, set.map->info));
    set.sessions.push_back(std::move(session));
  }
  return set;
}

}  // namespace maploc::selection
