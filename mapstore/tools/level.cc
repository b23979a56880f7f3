#include <cmath>
#include <iostream>
#include <vector>

#include "mapstore/base/angles.h"
#include "mapstore/base/clock.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/model/rotate_segment.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/copy_map.h"
#include "mapstore/tools/deleted_versions.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

// A turn that no accelerometer notices makes no version: the command may be repeated.
constexpr double kSmallestTurnRad = kMinGravitySigmaRad;

struct LevelFlags {
  std::string map;
  std::vector<double> gravity;  // three: down, in the map as it is
  Publishing publishing;
};

struct Levelled {
  MapKey before;
  MapKey after;  // the same where nothing changed
  Eigen::Vector3d gravity_in_map;
  double turn_rad = 0.0;
  std::vector<std::int64_t> deleted;  // by --keep-versions
};

Result<Eigen::Vector3d> ReadGravity(const std::vector<double>& flag) {
  const Eigen::Vector3d gravity(flag[0], flag[1], flag[2]);
  const double norm = gravity.norm();
  if (gravity.allFinite() && norm > 1e-9 && norm < 1e9) return Eigen::Vector3d(gravity / norm);
  return InvalidArgument("gravity",
                         "must be a finite direction other than 0,0,0 (down, in the map's frame)");
}

// An import like any other, so that the new version inherits what the old one's sessions taught.
Result<MapKey> WriteTurned(MapStore& store, const MapInfo& before,
                           const Eigen::Quaterniond& turned_from_map,
                           const Publishing& publishing) {
  MapInfo info = before;
  // Inheritance finds shared landmarks by this transform, so the turn must be in it.
  info.map_from_source = Similarity3{1.0, turned_from_map, {0, 0, 0}} * before.map_from_source;
  info.created_unix_ns = SystemClock().NowUnixNanos();
  return CopyMap(store, before.key, store, info, publishing,
                 [&](const Segment& segment) { return RotateSegment(turned_from_map, segment); });
}

Result<Levelled> TurnMap(MapStore& store, const std::string& map,
                         const Eigen::Vector3d& gravity_in_map, const Publishing& publishing) {
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary summary, store.GetMap(map));
  Levelled levelled{summary.info.key,
                    summary.info.key,
                    gravity_in_map,
                    AngleBetween(gravity_in_map, kGravityInMap),
                    {}};
  if (levelled.turn_rad < kSmallestTurnRad) return levelled;
  const Eigen::Quaterniond turned_from_map = CameraFromAligned(gravity_in_map).conjugate();
  MAPLOC_ASSIGN_OR_RETURN(levelled.after,
                          WriteTurned(store, summary.info, turned_from_map, publishing));
  return levelled;
}

nlohmann::ordered_json ToJson(const Levelled& levelled) {
  const Eigen::Vector3d& gravity = levelled.gravity_in_map;
  return {{"map", levelled.after.name},
          {"version", levelled.after.version},
          {"from_version", levelled.before.version},
          {"changed", levelled.after != levelled.before},
          {"turn_deg", levelled.turn_rad * kDegPerRad},
          {"gravity", {gravity.x(), gravity.y(), gravity.z()}},
          {"deleted_versions", levelled.deleted}};
}

void PrintText(const Levelled& levelled) {
  if (levelled.after == levelled.before) {
    std::cout << "Map " << levelled.before.name << " version " << levelled.before.version
              << " is level already; nothing was changed.\n";
    return;
  }
  std::cout << "Map " << levelled.after.name << " version " << levelled.after.version
            << " is version " << levelled.before.version << " turned by "
            << levelled.turn_rad * kDegPerRad << " degrees.\n";
  PrintDeleted(levelled.deleted);
}

Status Level(const CommandContext& context, const LevelFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const Eigen::Vector3d gravity, ReadGravity(flags.gravity));
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> before, store->ListVersions());
  MAPLOC_ASSIGN_OR_RETURN(Levelled levelled, TurnMap(*store, flags.map, gravity, flags.publishing));
  MAPLOC_ASSIGN_OR_RETURN(levelled.deleted, DeletedSince(before, *store, flags.map));
  if (context.json) return PrintJson(ToJson(levelled)), Status::Ok();
  PrintText(levelled);
  return Status::Ok();
}

}  // namespace

void AddLevelCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<LevelFlags>();
  CLI::App* command = AddCommand(
      app, context, "level",
      "Corrects a map's gravity: makes a new version in which it is (0, 0, -1)",
      "maploc-map level --store campus.db --map yard --gravity 0.02,0,-1\n"
      "The new version inherits what sessions taught. Where gravity is (0, 0, -1) already, "
      "nothing is changed.",
      [&context, flags] { return Level(context, *flags); });
  AddMapOption(*command, flags->map);
  command->add_option("--gravity", flags->gravity, "Down in the frame of the map as it is")
      ->required()
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  AddPublishingFlags(*command, flags->publishing);
}

}  // namespace maploc
