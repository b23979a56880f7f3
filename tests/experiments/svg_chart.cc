#include "tests/experiments/svg_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

namespace maploc::experiments {
namespace {

constexpr double kPanelWidth = 300;
constexpr double kPanelHeight = 240;
constexpr double kLeft = 64;    // room for tick labels
constexpr double kGap = 18;     // between panels
constexpr double kTop = 64;     // title and panel titles
constexpr double kBottom = 58;  // tick labels and the axis' name
constexpr double kLegendWidth = 150;
constexpr double kLegendLine = 18;
constexpr int kMaxPanelsARow = 4;

// Distinguishable colours (Paul Tol's "muted" and "bright"), then the same with other dashes.
constexpr std::array<const char*, 9> kColours = {"#332288", "#ee6677", "#117733",
                                                 "#ddaa33", "#4477aa", "#aa3377",
                                                 "#88ccee", "#999933", "#555555"};
constexpr std::array<const char*, 3> kDashes = {"", "6 3", "2 3"};

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '\'':
        escaped += "&apos;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Number(double value, const char* format = "%.1f") {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

// From a value to a place on an axis of `length`.
struct Axis {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;
  double length = 1.0;

  bool Shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  double Place(double value) const {
    return length * (Scale(value) - Scale(low)) / (Scale(high) - Scale(low));
  }

 private:
  double Scale(double value) const { return logarithmic ? std::log10(value) : value; }
};

Axis MakeAxis(const Chart& chart, double ChartPoint::*coordinate, bool logarithmic, double length) {
  Axis axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            logarithmic, length};
  for (const ChartPanel& panel : chart.panels) {
    for (const ChartSeries& series : panel.series) {
      for (const ChartPoint& point : series.points) {
        const double value = point.*coordinate;
        if (!axis.Shows(value)) continue;
        axis.low = std::min(axis.low, value);
        axis.high = std::max(axis.high, value);
      }
    }
  }
  if (!(axis.low <= axis.high)) axis.low = axis.high = 1.0;
  if (axis.low == axis.high) {
    axis.high = logarithmic ? 10 * axis.low : axis.low + 1;
  }
  return axis;
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart)
      : chart_(chart),
        x_(MakeAxis(chart, &ChartPoint::x, chart.log_x, kPanelWidth)),
        y_(MakeAxis(chart, &ChartPoint::y, chart.log_y, kPanelHeight)) {
    if (chart.y_is_share) {
      y_.low = 0;
      y_.high = 1;
    } else if (!chart.log_y) {
      y_.low = std::min(0.0, y_.low);
    }
    for (const ChartPanel& panel : chart.panels) {
      for (const ChartSeries& series : panel.series) {
        if (std::ranges::find(names_, series.name) == names_.end()) names_.push_back(series.name);
      }
    }
  }

  std::string Draw() {
    const int panels = std::max<int>(1, static_cast<int>(chart_.panels.size()));
    const int columns = std::min(panels, kMaxPanelsARow);
    const int rows = (panels + columns - 1) / columns;
    const double row_height = kPanelHeight + kTop + kBottom;
    const double width = kLeft + columns * (kPanelWidth + kGap) + kLegendWidth;
    const double height =
        std::max(rows * row_height, kTop + kLegendLine * (static_cast<double>(names_.size()) + 1));
    out_ << "<svg xmlns='http://www.w3.org/2000/svg' width='" << Number(width) << "' height='"
         << Number(height) << "' viewBox='0 0 " << Number(width) << " " << Number(height)
         << "' font-family='sans-serif' font-size='12'>\n"
         << "<rect width='100%' height='100%' fill='white'/>\n";
    Text(kLeft, 24, "start", chart_.title, 16);
    for (std::size_t i = 0; i < chart_.panels.size(); ++i) {
      const int column = static_cast<int>(i) % columns;
      const int row = static_cast<int>(i) / columns;
      DrawPanel(chart_.panels[i], kLeft + column * (kPanelWidth + kGap), kTop + row * row_height,
                column == 0);
    }
    DrawLegend(kLeft + columns * (kPanelWidth + kGap), kTop);
    out_ << "</svg>\n";
    return out_.str();
  }

 private:
  void Text(double x, double y, const char* anchor, const std::string& text, int size = 12,
            const std::string& more = "") {
    out_ << "<text x='" << Number(x) << "' y='" << Number(y) << "' text-anchor='" << anchor
         << "' font-size='" << size << "'" << more << ">" << Escaped(text) << "</text>\n";
  }
  void Line(double x1, double y1, double x2, double y2, const std::string& style) {
    out_ << "<line x1='" << Number(x1) << "' y1='" << Number(y1) << "' x2='" << Number(x2)
         << "' y2='" << Number(y2) << "' " << style << "/>\n";
  }
  std::string Stroke(const std::string& name) const {
    const std::size_t index =
        static_cast<std::size_t>(std::ranges::find(names_, name) - names_.begin());
    const std::string dash = kDashes[index / kColours.size() % kDashes.size()];
    return std::string("stroke='") + kColours[index % kColours.size()] +
           "' stroke-width='1.8' fill='none'" +
           (dash.empty() ? "" : " stroke-dasharray='" + dash + "'");
  }

  void DrawPanel(const ChartPanel& panel, double left, double top, bool first) {
    const double bottom = top + kPanelHeight;
    for (const double tick : AxisTicks(x_.low, x_.high, 6, x_.logarithmic)) {
      const double x = left + x_.Place(tick);
      Line(x, top, x, bottom, "stroke='#eeeeee'");
      Text(x, bottom + 16, "middle", Number(tick, "%.4g"));
    }
    for (const double tick : AxisTicks(y_.low, y_.high, 6, y_.logarithmic)) {
      const double y = bottom - y_.Place(tick);
      Line(left, y, left + kPanelWidth, y, "stroke='#dddddd'");
      if (first) Text(left - 6, y + 4, "end", Number(tick, "%.4g"));
    }
    out_ << "<rect x='" << Number(left) << "' y='" << Number(top) << "' width='"
         << Number(kPanelWidth) << "' height='" << Number(kPanelHeight)
         << "' fill='none' stroke='#444444'/>\n";
    Text(left + kPanelWidth / 2, top - 8, "middle", panel.title, 13);
    Text(left + kPanelWidth / 2, bottom + 36, "middle", chart_.x_label);
    if (first) {
      const double x = left - 46, y = top + kPanelHeight / 2;
      Text(x, y, "middle", chart_.y_label, 12,
           " transform='rotate(-90 " + Number(x) + " " + Number(y) + ")'");
    }
    for (const ChartSeries& series : panel.series) DrawSeries(series, left, bottom);
  }

  void DrawSeries(const ChartSeries& series, double left, double bottom) {
    std::ostringstream path, marks;
    for (const ChartPoint& point : series.points) {
      if (!x_.Shows(point.x) || !y_.Shows(point.y)) continue;
      const std::string x = Number(left + x_.Place(point.x));
      const std::string y = Number(bottom - y_.Place(point.y));
      path << x << "," << y << " ";
      marks << "<circle cx='" << x << "' cy='" << y << "' r='2.2' stroke-dasharray='none'/>";
    }
    out_ << "<g " << Stroke(series.name) << "><polyline points='" << path.str() << "'/>"
         << marks.str() << "</g>\n";
  }

  void DrawLegend(double left, double top) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const double y = top + 8 + kLegendLine * static_cast<double>(i);
      Line(left, y, left + 28, y, Stroke(names_[i]));
      Text(left + 34, y + 4, "start", names_[i]);
    }
  }

  const Chart& chart_;
  Axis x_, y_;
  std::vector<std::string> names_;
  std::ostringstream out_;
};

std::vector<double> LinearTicks(double low, double high, int count) {
  const double rough = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * (1 - 1e-9)) step = factor * power;
  }
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
    ticks.push_back(i * step + 0.0);  // never -0
  }
  return ticks;
}

std::vector<double> LogTicks(double low, double high) {
  const double decades = std::log10(high / low);
  std::vector<double> ticks;
  for (double power = std::floor(std::log10(low)); power <= std::log10(high); ++power) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * std::pow(10.0, power);
      const bool inside = tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9);
      if (inside && (factor == 1.0 || decades < 2.5)) ticks.push_back(tick);
    }
  }
  return ticks;
}

}  // namespace

std::vector<double> AxisTicks(double low, double high, int count, bool logarithmic) {
  return logarithmic ? LogTicks(low, high) : LinearTicks(low, high, count);
}

std::string DrawSvg(const Chart& chart) { return Drawing(chart).Draw(); }

}  // namespace maploc::experiments
