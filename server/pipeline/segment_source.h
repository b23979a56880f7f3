// Where the pipeline gets a map's segments from, when it needs them.
#pragma once

#include <memory>

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"
#include "mapstore/model/map.h"
#include "server/pipeline/interrupt.h"

namespace maploc {

// Thread-safe.
class SegmentSource {
 public:
  virtual ~SegmentSource() = default;
  // The segment, always with the same content; may wait for it to be loaded. CANCELLED or
  // DEADLINE_EXCEEDED as `interrupt` says; DATA_LOSS names what is damaged. REQUIRES: a segment of
  // the map.
  virtual Result<std::shared_ptr<const Segment>> Get(SegmentId id,
                                                     const Interrupt& interrupt) const = 0;
};

}  // namespace maploc
