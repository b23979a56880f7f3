#include "mapstore/tools/plot_svg.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include <Eigen/Geometry>

#include "mapstore/base/text.h"
#include "mapstore/tools/plot_colours.h"

namespace maploc {
namespace {

constexpr double kSidePx = 1000.0;
constexpr double kMarginPx = 40.0;
constexpr double kLegendPx = 90.0;

// Enough between tags. Quotes would matter in attributes only.
std::string Escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<') {
      escaped += "&lt;";
    } else if (c == '&') {
      escaped += "&amp;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

// From the map's plan to the picture: one scale for both axes, y up.
class Plan {
 public:
  void Include(const Eigen::Vector3d& point) { box_.extend(Eigen::Vector2d(point.head<2>())); }
  std::string X(const Eigen::Vector3d& point) const {
    return FixedText(kMarginPx + (point.x() - box_.min().x()) * Scale(), 1);
  }
  std::string Y(const Eigen::Vector3d& point) const {
    return FixedText(kLegendPx + (box_.max().y() - point.y()) * Scale(), 1);
  }
  double HeightPx() const { return kLegendPx + kMarginPx + box_.sizes().y() * Scale(); }

 private:
  double Scale() const {
    return (kSidePx - 2.0 * kMarginPx) / std::max(box_.sizes().maxCoeff(), 1e-9);
  }

  Eigen::AlignedBox2d box_;  // empty at first
};

// Far landmarks would shrink the rest to a dot: the picture shows the paths and a border of a third
// about them.
Plan Frame(const std::vector<SegmentSummary>& segments) {
  Eigen::AlignedBox3d box;
  for (const SegmentSummary& segment : segments) {
    for (const Eigen::Vector3d& position : segment.path_in_map) box.extend(position);
  }
  if (box.isEmpty()) box.extend(Eigen::Vector3d::Zero());
  // At least one unit, for a path that is a single point.
  const Eigen::Vector3d border =
      Eigen::Vector3d::Constant(std::max(box.sizes().maxCoeff() / 3.0, 1.0));
  Plan plan;
  plan.Include(box.min() - border);
  plan.Include(box.max() + border);
  return plan;
}

void DrawLandmarks(const Segment& segment, const Plan& plan, std::ostream& svg) {
  for (const LineSegment3& line : segment.lines.segments_in_map) {
    svg << "<path d='M" << plan.X(line.start) << " " << plan.Y(line.start) << "L"
        << plan.X(line.end) << " " << plan.Y(line.end) << "' stroke='#888' stroke-width='1'/>\n";
  }
  // One path for all points: a stroke of length 0 with round ends is drawn as a dot.
  svg << "<path stroke='#bbb' stroke-width='1.5' stroke-linecap='round' d='";
  for (const Eigen::Vector3d& point : segment.points.positions_in_map) {
    svg << "M" << plan.X(point) << " " << plan.Y(point) << "h0";
  }
  svg << "'/>\n";
}

void DrawPath(const SegmentSummary& segment, const std::string& colour, const Plan& plan,
              std::ostream& svg) {
  if (segment.path_in_map.empty()) return;
  svg << "<polyline fill='none' stroke-width='4' stroke-opacity='0.8' stroke='" << colour
      << "' points='";
  for (const Eigen::Vector3d& position : segment.path_in_map) {
    svg << plan.X(position) << "," << plan.Y(position) << " ";
  }
  const Eigen::Vector3d& middle = segment.path_in_map[segment.path_in_map.size() / 2];
  svg << "'/>\n<text x='" << plan.X(middle) << "' y='" << plan.Y(middle) << "'>" << segment.id
      << "</text>\n";
}

void DrawLegend(const std::string& title, PlotColour colour, std::ostream& svg) {
  svg << "<text x='" << kMarginPx << "' y='30' font-size='20'>" << Escape(title) << "</text>\n";
  double x = kMarginPx;
  for (const LegendEntry& entry : LegendOf(colour)) {
    svg << "<text x='" << x << "' y='58'><tspan fill='" << entry.colour << "'>&#9632;</tspan> "
        << Escape(entry.text) << "</text>\n";
    // An SVG cannot measure its text: a letter of this size takes about 8 px.
    x += 50.0 + 8.0 * static_cast<double>(entry.text.size());
  }
}

}  // namespace

std::string PlotSvg(const std::string& title, PlotColour colour,
                    const std::vector<SegmentSummary>& segments,
                    const std::vector<SegmentChanges>& changes,
                    const std::vector<std::shared_ptr<const Segment>>& landmarks) {
  const Plan plan = Frame(segments);
  std::ostringstream svg;
  svg << "<svg xmlns='http://www.w3.org/2000/svg' width='" << kSidePx << "' height='"
      << FixedText(plan.HeightPx(), 0)
      << "' font-family='sans-serif' font-size='14'>\n<rect width='100%' height='100%' "
         "fill='white'/>\n";
  // First, so that the paths lie over them.
  for (const auto& segment : landmarks) DrawLandmarks(*segment, plan, svg);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    DrawPath(segments[i], ColourOf(colour, segments[i], changes[i]), plan, svg);
  }
  DrawLegend(title, colour, svg);
  svg << "</svg>\n";
  return svg.str();
}

}  // namespace maploc
