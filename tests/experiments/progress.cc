#include "tests/experiments/progress.h"

#include <cstdio>
#include <utility>

#include <unistd.h>

namespace maploc::experiments {

Progress::Progress(std::string name, int total)
    : name_(std::move(name)), total_(total), shown_(isatty(STDERR_FILENO) != 0) {
  Print();
}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::Step() {
  ++done_;
  Print();
}

void Progress::Print() const {
  if (shown_) std::fprintf(stderr, "\r%s %d/%d", name_.c_str(), done_, total_);
}

}  // namespace maploc::experiments
