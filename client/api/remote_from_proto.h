// The answers of MapService as the client's plain values. A server that breaks its own contract is
// reported as INTERNAL with the field's name. Pure; thread-safe.
#pragma once

#include "client/api/client.h"
#include "mapstore/base/status.h"

namespace maploc::v1 {
class Map;
class Segment;
}  // namespace maploc::v1

namespace maploc {

Result<RemoteMap> RemoteMapFromProto(const v1::Map& map);
Result<RemoteSegment> RemoteSegmentFromProto(const v1::Segment& segment);

}  // namespace maploc
