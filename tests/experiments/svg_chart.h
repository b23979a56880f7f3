// Line charts as SVG: panels side by side with one legend. Well-formed XML, whatever the names.
#pragma once

#include <string>
#include <vector>

namespace maploc::experiments {

struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
};

struct ChartSeries {
  std::string name;  // the legend's; the same name has the same colour in every panel
  std::vector<ChartPoint> points;
};

struct ChartPanel {
  std::string title;
  std::vector<ChartSeries> series;
};

struct Chart {
  std::string title;
  std::string x_label;
  std::string y_label;
  bool log_x = false;  // points at zero or below are left out
  bool log_y = false;
  bool y_is_share = false;  // the axis is [0, 1]
  std::vector<ChartPanel> panels;
};

// The document. All panels share their axes' ranges; points that are not finite are left out.
std::string DrawSvg(const Chart& chart);

// Up to about `count` round values that cover [low, high]: 1, 2 or 5 times a power of ten; on a
// logarithmic axis powers of ten, with 2 and 5 between where there are few.
std::vector<double> AxisTicks(double low, double high, int count, bool logarithmic);

}  // namespace maploc::experiments
