#include "client/cli/recording_flags.h"

#include "mapstore/base/usage.h"

namespace maploc {

void AddRecordingFlags(CLI::App& command, RecordingOptions& options) {
  command
      .add_option("--colmap", options.model_dir,
                  "COLMAP model, text or binary, of the reference poses; they are never sent")
      ->required();
  command.add_option("--database", options.database, "COLMAP database.db: the points to send");
  command.add_option("--images", options.images,
                     "folder of the photos: the lines to send, and the points without --database");
  // A measured gravity takes no noise, and one that is not sent neither that nor a sigma: flags
  // that would be ignored exclude each other.
  CLI::Option* csv =
      command.add_option("--gravity-csv", options.gravity.csv,
                         "measured gravity, name,gx,gy,gz: down, camera frame, unit or in m/s^2");
  CLI::Option* noise =
      command
          .add_option("--gravity-noise-deg", options.gravity.noise_deg,
                      "gravity from the reference as the map has it (a wrong gravity of the map is "
                      "therefore not noticed), rotated by N(0, S) about the two horizontal axes; "
                      "without it and without --gravity-csv the exact direction is sent")
          ->excludes(csv);
  CLI::Option* sigma =
      command.add_option("--gravity-sigma-deg", options.gravity.sigma_deg,
                         "standard deviation that is sent, above 0 and at most 90 (default: the "
                         "noise, but at least 0.05, or 1 with a CSV)");
  command
      .add_flag("--without-gravity", options.gravity.none,
                "send no gravity, as `localize` without --gravity")
      ->excludes(csv)
      ->excludes(noise)
      ->excludes(sigma);
  command.add_option("--max-features", options.max_features,
                     "points of a query, the strongest (default: the server's limit of 20000 from "
                     "--database, 5000 from --images)");
  command.add_option("--seed", options.gravity.seed, "of the gravity noise")->capture_default_str();
}

void AddMethodFlags(CLI::App& command, MethodFlags& flags) {
  command
      .add_option("--strategy", flags.strategy, "how samples are drawn; auto: the segment's own")
      ->check(CLI::IsMember({"auto", "1p1l", "2p", "mixed", "p3p"}))
      ->capture_default_str();
  command.add_option("--refine", flags.refine, "how the pose is refined")
      ->check(CLI::IsMember({"auto", "4dof", "6dof"}))
      ->capture_default_str();
  command
      .add_option("--max-error", flags.max_error_px,
                  "inlier threshold in pixels of the photo (default: the server's, by the photo's "
                  "size)")
      ->check(NumberIn(0.1, 1000.0));
}

CLI::Validator LabelCheck() {
  return CLI::Validator(
      [](std::string& label) {
        const std::size_t equals = label.find('=');
        const bool good = equals != std::string::npos && equals > 0;
        return good ? std::string() : "'" + label + "' is not KEY=VALUE";
      },
      "KEY=VALUE");
}

std::map<std::string, std::string> ParseLabels(const std::vector<std::string>& labels) {
  std::map<std::string, std::string> parsed;
  for (const std::string& label : labels) {
    const std::size_t equals = label.find('=');
    parsed[label.substr(0, equals)] = label.substr(equals + 1);
  }
  return parsed;
}

}  // namespace maploc
