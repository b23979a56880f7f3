// What the robots of one season get, as it comes in: a row a robot, a mark a query. On a terminal
// the rows fill live; elsewhere each is printed when its robot has finished.
#pragma once

#include <iosfwd>
#include <mutex>
#include <string>
#include <vector>

#include "client/robot/replay.h"

namespace maploc {

// Thread-safe: robots report from their own threads.
class SeasonBoard {
 public:
  // `out` is written to; `live` where it is a terminal.
  SeasonBoard(std::ostream& out, bool live, std::vector<std::string> robots, int queries);

  void Add(int robot, const ReplayEntry& entry);

 private:
  struct Row {
    std::string robot;
    std::string marks;
    int answers = 0;
    int localized = 0;
    std::vector<double> translation_errors_m;
    std::vector<double> rotation_errors_deg;
    std::vector<double> latencies_ms;
  };

  void Redraw();
  std::string Line(const Row& row) const;

  std::mutex mutex_;
  std::ostream& out_;
  const bool live_;
  const int queries_;
  std::vector<Row> rows_;
};

}  // namespace maploc
