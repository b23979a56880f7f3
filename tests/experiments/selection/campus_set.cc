#include "tests/experiments/selection/campus_set.h"

#include <cstdlib>
#include <filesystem>

#include "client/robot/simulated_map.h"
#include "client/robot/simulated_robot.h"
#include "mapstore/base/random.h"
#include "tests/experiments/selection/campus_days.h"

namespace maploc::selection {
namespace {

constexpr double kLookAheadM = 8.0;  // where the camera, turned to the right, mostly looks
constexpr double kNoisePx = 1.0;

// Gone with its content when it goes out of scope.
class ScratchFolder {
 public:
  static Result<ScratchFolder> Create() {
    std::string path = (std::filesystem::temp_directory_path() / "maploc-campus-XXXXXX").string();
    if (mkdtemp(path.data()) == nullptr) {
      return FailedPrecondition("NO_SCRATCH_FOLDER",
                                "cannot make " + path + "; set TMPDIR to a writable folder");
    }
    return ScratchFolder(path);
  }
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::move(other.path_)) {
    other.path_.clear();
  }
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  explicit ScratchFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
};

Result<std::shared_ptr<const MapSnapshot>> MapCampus(const World& world) {
  MAPLOC_ASSIGN_OR_RETURN(const ScratchFolder folder, ScratchFolder::Create());
  MappingOptions mapping;
  mapping.position_noise_m = 0.02;
  mapping.line_noise_m = 0.02;
  mapping.start_m = 0.0;
  mapping.sight.noise_px = kNoisePx;
  MAPLOC_RETURN_IF_ERROR(WriteMappingDrive(world, mapping, folder.path()).status());
  ColmapImportOptions import;
  import.map_name = "campus";
  import.model_directory = folder.path() + "/model";
  import.database_path = folder.path() + "/database.db";
  import.line_file = folder.path() + "/lines.txt";
  import.gravity_in_source = Eigen::Vector3d(0, 0, -1);
  import.meters_per_unit = 1.0;
  import.detect_lines = false;
  MAPLOC_ASSIGN_OR_RETURN(import.descriptors, DescriptorKindFromName("orb"));
  return ImportMap(import);
}

Scene SceneAt(const World& world, double along_m) {
  switch (world.SiteOf(world.StretchAt(along_m))) {
    case Site::kHouses:
      return Scene::kStructured;
    case Site::kTrees:
      return Scene::kUnstructured;
    default:
      return Scene::kMixture;
  }
}

Result<SetSession> DriveDay(const World& world, const MapInfo& map, const CampusDay& day,
                            const CampusSetOptions& options) {
  DriveOptions drive;
  drive.queries = options.queries;
  drive.name = day.name;
  drive.appearance = day.appearance;
  drive.gravity_noise_deg = day.gravity_noise_deg;
  drive.sight.noise_px = kNoisePx;
  drive.seed = HashBytes(day.name, options.seed);
  const SimulatedRobot robot(world, drive, map);
  SetSession session{std::string(day.name), {}};
  for (int i = 0; i < robot.QueryCount(); ++i) {
    MAPLOC_ASSIGN_OR_RETURN(Query query, robot.MakeQuery(i));
    const double along_m = drive.start_m + i * world.LaneLength() / options.queries + kLookAheadM;
    session.queries.push_back({robot.QueryName(i), std::move(query), robot.ReferenceMapFromBody(i),
                               SceneAt(world, along_m)});
  }
  return session;
}

}  // namespace

Result<SelectionSet> MakeCampusSet(const CampusSetOptions& options) {
  CampusOptions places = CampusPlaces();
  places.seed = options.seed;
  const World world = MakeCampus(places);
  SelectionSet set;
  MAPLOC_ASSIGN_OR_RETURN(set.map, MapCampus(world));
  for (const CampusDay& day : CampusDays()) {
    MAPLOC_ASSIGN_OR_RETURN(SetSession session, DriveDay(world, set.map->info, day, options));
    set.sessions.push_back(std::move(session));
  }
  return set;
}

}  // namespace maploc::selection
