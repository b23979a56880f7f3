#include "mapstore/tools/import_colmap.h"

#include <chrono>
#include <filesystem>
#include <iostream>
#include <system_error>

#include <unistd.h>

#include "mapstore/base/angles.h"
#include "mapstore/base/table.h"
#include "mapstore/importers/colmap_importer.h"
#include "mapstore/tools/deleted_versions.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

// The flags as they were given, and what they mean.
struct Flags {
  ColmapImportOptions options;
  std::vector<double> gravity;  // empty or three
  std::string lines = "auto";
  std::string descriptors;  // empty: by the source
};

// A line that overwrites itself; nothing where nobody watches.
ProgressFn TerminalProgress() {
  if (isatty(STDERR_FILENO) == 0) return nullptr;
  return [](std::string_view stage, int done, int total) {
    std::cerr << "\r\033[K" << stage << " " << done << "/" << total;
    if (done == total) std::cerr << "\n";
    std::cerr.flush();
  };
}

Result<ColmapImportOptions> ReadFlags(const Flags& flags) {
  ColmapImportOptions options = flags.options;
  if (!flags.gravity.empty()) {
    options.gravity_in_source =
        Eigen::Vector3d(flags.gravity[0], flags.gravity[1], flags.gravity[2]);
  }
  options.detect_lines = flags.lines == "auto";
  if (flags.lines != "auto" && flags.lines != "none") options.line_file = flags.lines;
  if (!flags.descriptors.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(options.descriptors, DescriptorKindFromName(flags.descriptors));
  }
  return options;
}

const char* SourceName(GravityOrigin source) {
  switch (source) {
    case GravityOrigin::kGiven:
      return "given";
    case GravityOrigin::kMeasured:
      return "measured";
    case GravityOrigin::kEstimated:
      break;
  }
  return "estimated";
}

nlohmann::ordered_json ToJson(const ColmapImportReport& report, double seconds) {
  const Eigen::Vector3d& gravity = report.gravity.down_in_source;
  const Eigen::Quaterniond& rotation = report.info.map_from_source.rotation;
  return {
      {"map", report.info.key.name},
      {"version", report.info.key.version},
      {"metric", report.info.metric},
      {"segments", report.segments},
      {"points", report.points},
      {"lines", report.lines},
      {"usable_lines", report.usable_lines},
      {"frames", report.frames},
      {"point_descriptor", report.info.point_descriptor.name},
      {"line_descriptor", report.info.line_descriptor.name},
      {"point_descriptors", report.point_descriptors},
      {"line_descriptors", report.line_descriptors},
      {"points_without_descriptor", report.points_without_descriptor},
      {"segment_length", report.segment_length},
      {"gravity", {gravity.x(), gravity.y(), gravity.z()}},
      {"gravity_source", SourceName(report.gravity.source)},
      {"gravity_interval_deg", report.gravity.interval_rad * kDegPerRad},
      {"gravity_basis", report.gravity.basis},
      {"map_from_source",
       {{"scale", report.info.map_from_source.scale},
        {"rotation",
         {{"x", rotation.x()}, {"y", rotation.y()}, {"z", rotation.z()}, {"w", rotation.w()}}}}},
      {"notices", report.notices},
      {"seconds", seconds}};
}

void PrintSummary(const ColmapImportReport& report, double seconds) {
  const char* unit = report.info.metric ? " m" : " units";
  Table table({"map", "version", "photos", "segments", "points", "lines", "usable lines", "unit"});
  table.AddRow({report.info.key.name, std::to_string(report.info.key.version),
                std::to_string(report.frames), std::to_string(report.segments),
                std::to_string(report.points), std::to_string(report.lines),
                std::to_string(report.usable_lines), report.info.metric ? "metres" : "unknown"});
  table.Print(std::cout);
  std::cout << report.point_descriptors << " descriptors " << report.info.point_descriptor.name;
  if (report.lines > 0) {
    std::cout << ", " << report.line_descriptors << " " << report.info.line_descriptor.name;
  }
  std::cout << "; stretches of " << report.segment_length << unit << "; " << seconds << " s\n";
}

// What was not given is always told: a map that leans is useless to a robot that knows where down
// is.
void TellGravity(const SourceGravity& gravity) {
  if (gravity.source != GravityOrigin::kGiven) {
    const Eigen::Vector3d& g = gravity.down_in_source;
    std::cerr << "gravity " << SourceName(gravity.source) << " from " << gravity.basis << ": "
              << g.x() << "," << g.y() << "," << g.z()
              << " (down, in the model's frame), 95% within " << gravity.interval_rad * kDegPerRad
              << " degrees\n";
  }
  if (!gravity.warning.empty()) std::cerr << "warning: " << gravity.warning << "\n";
}

Status Import(const CommandContext& context, const Flags& flags) {
  const auto start = std::chrono::steady_clock::now();
  MAPLOC_ASSIGN_OR_RETURN(const ColmapImportOptions options, ReadFlags(flags));
  std::unique_ptr<MapStore> store;
  std::vector<MapSummary> before;
  const auto open = [&]() -> Result<MapStore*> {
    if (store == nullptr) {
      MAPLOC_ASSIGN_OR_RETURN(store, OpenOrCreateStore(context));
      MAPLOC_ASSIGN_OR_RETURN(before, store->ListVersions());
    }
    return store.get();
  };
  // A store that is there is tried before the work; one that is not is made after it.
  std::error_code error;
  const bool exists = std::filesystem::exists(context.store_path, error);
  if (error) return InvalidFile(context.store_path, error.message());
  if (exists) MAPLOC_RETURN_IF_ERROR(open().status());
  MAPLOC_ASSIGN_OR_RETURN(const ColmapImportReport report,
                          ImportColmap(options, open, TerminalProgress()));
  MAPLOC_ASSIGN_OR_RETURN(const auto deleted, DeletedSince(before, *store, report.info.key.name));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  for (const std::string& notice : report.notices) std::cerr << "note: " << notice << "\n";
  TellGravity(report.gravity);
  if (context.json) {
    nlohmann::ordered_json document = ToJson(report, elapsed.count());
    document["deleted_versions"] = deleted;
    PrintJson(document);
  } else {
    PrintSummary(report, elapsed.count());
    PrintDeleted(deleted);
  }
  return Status::Ok();
}

// As a check of CLI11, so that an unknown kind is wrong usage (exit code 2).
std::string CheckDescriptorKind(const std::string& name) {
  const Result<DescriptorKind> kind = DescriptorKindFromName(name);
  return kind.ok() ? "" : kind.status().message();
}

void AddSourceFlags(CLI::App& command, Flags& flags) {
  command.add_option("--map", flags.options.map_name, "The map's name; a new version if it exists")
      ->required()
      ->type_name("NAME");
  command.add_option("--model", flags.options.model_directory, "COLMAP model, text or binary")
      ->required()
      ->type_name("DIR");
  command
      .add_option("--database", flags.options.database_path, "database.db: descriptors of points")
      ->type_name("FILE");
  command.add_option("--images", flags.options.images_directory, "The photos: lines, and features")
      ->type_name("DIR");
  command
      .add_option(
          "--descriptors", flags.descriptors,
          "orb, sift_root_u8, sift_u8, unitN or binaryN; else the database's, or sift_root_u8")
      ->check(CheckDescriptorKind)
      ->type_name("KIND");
  command.add_flag("--triangulate", flags.options.triangulate,
                   "Triangulate the points again from the photos");
}

void AddMapFlags(CLI::App& command, Flags& flags) {
  command
      .add_option("--gravity", flags.gravity,
                  "Down in the model's frame; else as the database's pose_priors have it, or "
                  "estimated from the photos")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  AddPublishingFlags(command, flags.options.publishing);
  command.add_flag("--force", flags.options.force, "Take a gravity that the photos contradict");
  command
      .add_option("--scale", flags.options.meters_per_unit,
                  "Makes the map metric; else its unit is unknown")
      ->type_name("METRES_PER_UNIT");
  command
      .add_option("--segment-length", flags.options.segment_length,
                  "Length of a segment's stretch of the path; else twice the scene's depth")
      ->type_name("M");
  command
      .add_option("--lines", flags.lines,
                  "auto: from the photos, when given; none; or a maploc-lines file")
      ->capture_default_str()
      ->type_name("auto|none|FILE");
}

}  // namespace

void AddImportColmap(CLI::App& app, CommandContext& context) {
  const auto flags = std::make_shared<Flags>();
  CLI::App* command = AddCommand(
      app, context, "import-colmap", "Makes a map of a COLMAP model",
      "maploc-map import-colmap --store campus.db --map yard --model sparse/0 --database "
      "database.db --images photos --gravity 0,1,0 --scale 1",
      [&context, flags] { return Import(context, *flags); });
  AddSourceFlags(*command, *flags);
  AddMapFlags(*command, *flags);
}

}  // namespace maploc
