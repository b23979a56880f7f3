// What every store refuses, whatever it keeps its data in. Errors name the field.
#pragma once

#include <optional>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/model/map.h"
#include "mapstore/model/session.h"

namespace maploc {

// Name (as CheckName, and not empty), kinds, and a similarity with finite numbers, a positive scale
// and a unit rotation.
Status ValidateMapInfo(const MapInfo& info);
// Id (printable ASCII), that it is open, and that its times are not negative.
Status ValidateNewSession(const Session& session);
// A sequence from 1, a segment from -1, counts that fit each other, finite numbers.
Status ValidateObservation(const Observation& observation);
// ValidateSegment, the path's numbers, and that its id is the one that comes next.
Status ValidateNextSegment(const MapInfo& info, const Segment& segment, SegmentId next);
// The reason of the end is given. (A session may end before it started: a clock can be set back.)
Status ValidateSessionEnd(SessionEnd end);
// A pin is one of the selector's strategies.
Status ValidatePin(const std::optional<Strategy>& pinned);

// The failures that all stores tell in the same words.
Status EmptyMap(const MapKey& key);
Status ImportCommitted();
Status SessionExists(const SessionId& id);
Status UnknownMap(const std::string& name);
Status UnknownMap(const MapKey& key);
Status NoVersionEnabled(const std::string& name);  // NOT_FOUND, with the cure
Status VersionEnabled(const MapKey& key);
Status VersionInUse(const MapKey& key, std::int64_t open_sessions);
Status UnknownSegment(const MapKey& key, SegmentId id);
Status UnknownSession(const SessionId& id);

}  // namespace maploc
