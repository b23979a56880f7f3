// Whether what a command printed has arrived: a full disk or a closed pipe is told by the flush
// alone.
#pragma once

#include "mapstore/base/status.h"

namespace maploc {

// Gives the numbers of standard input, output and error that the caller has closed to /dev/null.
// Else the next file that the program opens has that number, and gets what is printed. To be called
// first of all.
void OpenStandardFiles();

// Writes out what std::cout and stdio still hold. DATA_LOSS (OUTPUT_LOST) when that, or anything
// printed before, failed. To be called once a command has printed all, before it says that it is
// done.
Status FlushStandardOutput();

}  // namespace maploc
