// Whether what a command printed has arrived: a full disk or a closed pipe is told by the flush
// alone.
#pragma once

#include "mapstore/base/status.h"

namespace maploc {

// Writes out what std::cout and stdio still hold. DATA_LOSS (OUTPUT_LOST) when that, or anything
// printed before, failed. To be called once a command has printed all, before it says that it is
// done.
Status FlushStandardOutput();

}  // namespace maploc
