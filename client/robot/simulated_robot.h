// A robot that drives once around the made-up campus in one season. Its body frame is x forward, y
// left, z up; its camera looks 40 degrees to the right, from 1.2 m above the ground.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/robot/robot.h"
#include "client/robot/simulated_view.h"
#include "mapstore/model/map.h"

namespace maploc {

struct DriveOptions {
  int queries = 45;      // evenly along the lane
  double aside_m = 0.5;  // to the right of the lane's middle, on average
  double start_m = 0.0;  // along the lane
  double gravity_noise_deg = 0.5;
  Season season = Season::kSummer;
  std::string name;                      // of its queries; empty: the season's
  std::optional<Appearance> appearance;  // of the day; default: the season's
  SightOptions sight;
  std::uint64_t seed = 1;
};

// The camera as it is mounted on every simulated robot.
Rigid3 SimulatedCameraFromBody();
// A body on the lane, level but for `roll_rad` and `pitch_rad`.
Rigid3 WorldFromBody(const World& world, double along_m, double aside_m, double turn_rad,
                     double roll_rad, double pitch_rad);

// Keeps a reference to `world`, which must outlive it.
class SimulatedRobot : public Robot {
 public:
  // `map` says where the importer has put the world's frame.
  SimulatedRobot(const World& world, const DriveOptions& options, const MapInfo& map);

  int QueryCount() const override { return static_cast<int>(world_from_body_.size()); }
  std::string QueryName(int index) const override;
  // The same index gives the same query.
  Result<Query> MakeQuery(int index) const override;
  Rigid3 ReferenceMapFromBody(int index) const override;
  std::optional<double> SceneDepth(int) const override { return std::nullopt; }

 private:
  const World& world_;
  const DriveOptions options_;
  const MapInfo map_;
  const Camera camera_ = SimulatedCamera();
  std::vector<Rigid3> world_from_body_;
};

}  // namespace maploc
