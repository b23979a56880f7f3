#include "mapstore/base/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include <fcntl.h>
#include <unistd.h>

namespace maploc {

void OpenStandardFiles() {
  // Open takes the lowest number that is free.
  int file = 0;
  while (file >= 0 && file <= STDERR_FILENO) file = open("/dev/null", O_RDWR);
  if (file > STDERR_FILENO) close(file);
}

Status FlushStandardOutput() {
  errno = 0;
  std::cout.flush();
  std::fflush(stdout);
  if (std::cout.good() && std::ferror(stdout) == 0) return Status::Ok();
  // If an earlier write failed, its error number is gone.
  const std::string cause =
      errno != 0 ? std::strerror(errno) : "the disk is full, or whoever read it has gone";
  return Status(StatusCode::kDataLoss, "OUTPUT_LOST",
                "standard output cannot be written: " + cause +
                    "; what was to be printed is lost or cut short, what the command changed is "
                    "done");
}

}  // namespace maploc
