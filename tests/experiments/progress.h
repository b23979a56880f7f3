// "robustness 12/72" on standard error, on one line, when that is a terminal.
#pragma once

#include <string>

namespace maploc::experiments {

class Progress {
 public:
  Progress(std::string name, int total);
  ~Progress();  // wipes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Step();

 private:
  void Print() const;

  const std::string name_;
  const int total_;
  const bool shown_;
  int done_ = 0;
};

}  // namespace maploc::experiments
