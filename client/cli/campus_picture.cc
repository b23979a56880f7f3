#include "client/cli/campus_picture.h"

#include <array>
#include <fstream>
#include <sstream>

namespace maploc {
namespace {

constexpr double kPxPerM = 8.0;
constexpr double kMarginM = 20.0;  // beyond the lane: houses, trees and names
constexpr double kLegendPx = 150.0;

const char* const kWallColour = "#555555";
const char* const kTreeColour = "#cfe8c4";
const char* const kGoodColour = "#222222";
const char* const kCoarseColour = "#d62728";

// An SVG document in the world's plan: x right, y up.
class Picture {
 public:
  Picture(const World& world, const MapInfo& map)
      : world_from_map_(map.map_from_source.Inverse()),
        half_px_((world.radius_m + kMarginM) * kPxPerM) {
    svg_.precision(6);
  }

  void Walls(const World& world) {
    for (const Wall& wall : world.walls) {
      Line(wall.start, wall.end, kWallColour, 4.0);
    }
    for (const Tree& tree : world.trees) {
      const Eigen::Vector2d at = Px(tree.position);
      svg_ << "<circle cx='" << at.x() << "' cy='" << at.y() << "' r='"
           << tree.crown_radius_m * kPxPerM << "' fill='" << kTreeColour << "'/>\n";
    }
  }

  void Segment(const RemoteSegment& segment) {
    if (segment.path_in_map.empty()) return;
    svg_ << "<polyline fill='none' stroke-linecap='round' stroke-opacity='0.45' stroke-width='22' "
            "stroke='"
         << StrategyColour(segment.decision.strategy) << "' points='";
    for (const Eigen::Vector3d& point_in_map : segment.path_in_map) Point(InWorld(point_in_map));
    svg_ << "'/>\n";
    const Eigen::Vector2d middle = InWorld(segment.path_in_map[segment.path_in_map.size() / 2]);
    // The world's origin is the lane's centre, so that the label stands inside of the lane.
    Label(middle * 0.72, "segment " + std::to_string(segment.id) + ": " +
                             std::string(StrategyName(segment.decision.strategy)));
  }

  // The true path as a thin line, each estimate as a dot joined to its truth, each miss as a cross.
  void Session(const ReplayReport& session) {
    svg_ << "<polyline fill='none' stroke='#888888' stroke-width='1' points='";
    for (const ReplayEntry& entry : session.entries) Point(Reference(entry));
    svg_ << "'/>\n";
    for (const ReplayEntry& entry : session.entries) {
      const auto& estimate = entry.localization.map_from_body;
      estimate ? Estimate(entry, InWorld(estimate->translation)) : Miss(Reference(entry));
    }
  }

  void Legend() {
    double y = 24.0;
    const auto row = [&](const std::string& shape, const std::string& text) {
      svg_ << "<g transform='translate(16," << y << ")'>" << shape
           << "<text x='34' y='5' font-size='14'>" << text << "</text></g>\n";
      y += 22.0;
    };
    for (const Strategy strategy : {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed}) {
      row("<line x1='0' x2='26' y1='0' y2='0' stroke-width='12' stroke-opacity='0.45' stroke='" +
              StrategyColour(strategy) + "'/>",
          "segment drawn with " + std::string(StrategyName(strategy)));
    }
    row("<line x1='0' x2='26' y1='0' y2='0' stroke='#888888'/>", "true path");
    row("<circle cx='13' r='3' fill='" + std::string(kGoodColour) + "'/>", "estimate");
    row("<circle cx='13' r='4' fill='" + std::string(kCoarseColour) + "'/>",
        "estimate, off by more than 0.25 m or 2 degrees");
    row("<path d='M9-4l8 8m0-8l-8 8' stroke='" + std::string(kCoarseColour) + "'/>",
        "not localized");
  }

  Status Write(const std::string& path) const {
    std::ofstream file(path);
    file << "<svg xmlns='http://www.w3.org/2000/svg' font-family='sans-serif' width='"
         << 2.0 * half_px_ << "' height='" << 2.0 * half_px_ + kLegendPx << "'>\n"
         << "<rect width='100%' height='100%' fill='white'/>\n"
         << svg_.str() << "</svg>\n";
    // A full disk may show only now, when the stream writes what it has buffered.
    file.flush();
    if (file) return Status::Ok();
    return InvalidArgument("--picture", "'" + path + "' could not be written");
  }

 private:
  Eigen::Vector2d InWorld(const Eigen::Vector3d& point_in_map) const {
    return (world_from_map_ * point_in_map).head<2>();
  }
  Eigen::Vector2d Reference(const ReplayEntry& entry) const {
    return InWorld(entry.reference_map_from_body.translation);
  }
  Eigen::Vector2d Px(const Eigen::Vector2d& in_world) const {
    // An SVG's y runs down.
    return {half_px_ + in_world.x() * kPxPerM, half_px_ - in_world.y() * kPxPerM + kLegendPx};
  }
  void Point(const Eigen::Vector2d& in_world) {
    const Eigen::Vector2d at = Px(in_world);
    svg_ << at.x() << "," << at.y() << " ";
  }
  void Line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const char* colour,
            double width) {
    const Eigen::Vector2d a = Px(from);
    const Eigen::Vector2d b = Px(to);
    svg_ << "<line x1='" << a.x() << "' y1='" << a.y() << "' x2='" << b.x() << "' y2='" << b.y()
         << "' stroke='" << colour << "' stroke-width='" << width << "'/>\n";
  }
  void Label(const Eigen::Vector2d& at_in_world, const std::string& text) {
    const Eigen::Vector2d at = Px(at_in_world);
    svg_ << "<text text-anchor='middle' font-size='16' x='" << at.x() << "' y='" << at.y() << "'>"
         << text << "</text>\n";
  }
  void Estimate(const ReplayEntry& entry, const Eigen::Vector2d& in_world) {
    const bool good = entry.error->translation_m <= kRecallThresholds[0].translation_m &&
                      entry.error->rotation_deg <= kRecallThresholds[0].rotation_deg;
    const char* colour = good ? kGoodColour : kCoarseColour;
    Line(Reference(entry), in_world, colour, 1.0);
    const Eigen::Vector2d at = Px(in_world);
    svg_ << "<circle cx='" << at.x() << "' cy='" << at.y() << "' r='" << (good ? 1.5 : 4.0)
         << "' fill='" << colour << "'/>\n";
  }
  void Miss(const Eigen::Vector2d& in_world) {
    const Eigen::Vector2d at = Px(in_world);
    svg_ << "<path transform='translate(" << at.x() << "," << at.y()
         << ")' d='M-4-4l8 8m0-8l-8 8' stroke='" << kCoarseColour << "'/>\n";
  }

  const Similarity3 world_from_map_;
  const double half_px_;
  std::ostringstream svg_;
};

}  // namespace

std::string StrategyColour(Strategy strategy) {
  constexpr std::array<const char*, 4> kColours = {"#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd"};
  // Strategies are numbered from 1, as on the wire.
  return kColours[static_cast<int>(strategy) - 1];
}

Status WriteCampusPicture(const std::string& path, const World& world, const MapInfo& map,
                          const std::vector<RemoteSegment>& segments,
                          const std::vector<ReplayReport>& sessions) {
  Picture picture(world, map);
  picture.Walls(world);
  for (const RemoteSegment& segment : segments) picture.Segment(segment);
  for (const ReplayReport& session : sessions) picture.Session(session);
  picture.Legend();
  return picture.Write(path);
}

}  // namespace maploc
