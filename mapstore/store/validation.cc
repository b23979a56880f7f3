#include "mapstore/store/validation.h"

#include <algorithm>
#include <cmath>

#include "mapstore/base/ids.h"
#include "mapstore/base/name.h"

namespace maploc {
namespace {

Status ValidateKind(const DescriptorKind& kind, std::string_view field) {
  if (kind.name.empty()) {
    if (kind.bytes == 0) return Status::Ok();
    return InvalidArgument(field, "a descriptor kind without a name must have 0 bytes");
  }
  if (kind.bytes < 1 || kind.bytes > kMaxDescriptorBytes) {
    return InvalidArgument(field, "its bytes must be in 1 to " +
                                      std::to_string(kMaxDescriptorBytes) + ", not " +
                                      std::to_string(kind.bytes));
  }
  return CheckName(field, kind.name);
}

Status ValidateCounts(const FeatureCounts& counts, std::string_view field) {
  if (0 <= counts.inliers && counts.inliers <= counts.matches) return Status::Ok();
  return InvalidArgument(field, "needs 0 <= inliers <= matches");
}

bool IsSelectable(Strategy strategy) {
  return strategy == Strategy::k1P1L || strategy == Strategy::k2P || strategy == Strategy::kMixed;
}

}  // namespace

Status ValidateMapInfo(const MapInfo& info) {
  if (info.key.name.empty()) return InvalidArgument("map.name", "is required", "REQUIRED");
  MAPLOC_RETURN_IF_ERROR(CheckName("map.name", info.key.name));
  MAPLOC_RETURN_IF_ERROR(ValidateKind(info.point_descriptor, "map.point_descriptor"));
  MAPLOC_RETURN_IF_ERROR(ValidateKind(info.line_descriptor, "map.line_descriptor"));
  const Similarity3& transform = info.map_from_source;
  const bool good = std::isfinite(transform.scale) && transform.scale > 0.0 &&
                    transform.translation.allFinite() &&
                    std::abs(transform.rotation.norm() - 1.0) < 1e-6;
  if (!good) {
    return InvalidArgument("map.map_from_source",
                           "needs a positive scale, a unit rotation and finite numbers");
  }
  return Status::Ok();
}

Status ValidateNewSession(const Session& session) {
  // Stricter than a name: ids are made by programs, and people paste them into commands.
  const bool printable = std::all_of(session.id.begin(), session.id.end(),
                                     [](char c) { return 0x20 < c && c < 0x7f; });
  if (session.id.empty() || session.id.size() > static_cast<std::size_t>(kMaxIdBytes) ||
      !printable) {
    return InvalidArgument("session.id", "must be 1 to " + std::to_string(kMaxIdBytes) +
                                             " printable ASCII characters");
  }
  if (session.end != SessionEnd::kOpen) {
    return InvalidArgument("session.end", "a session starts open");
  }
  if (session.start_unix_ns < 0) {
    return InvalidArgument("session.start_unix_ns", "is before 1970; set this machine's clock");
  }
  return Status::Ok();
}

Status ValidateObservation(const Observation& observation) {
  if (observation.sequence < 1) return InvalidArgument("observation.sequence", "counts from 1");
  // -1 is an observation in no segment.
  if (observation.segment < -1) return InvalidArgument("observation.segment", "is negative");
  const Evidence& evidence = observation.evidence;
  MAPLOC_RETURN_IF_ERROR(ValidateCounts(evidence.points, "observation.points"));
  MAPLOC_RETURN_IF_ERROR(ValidateCounts(evidence.usable_lines, "observation.usable_lines"));
  MAPLOC_RETURN_IF_ERROR(ValidateCounts(evidence.vertical_lines, "observation.vertical_lines"));
  if (!std::isfinite(evidence.gravity_disagreement_rad) || !evidence.gravity_tilt_rad.allFinite() ||
      !std::isfinite(evidence.confidence) || !std::isfinite(evidence.inlier_rms_px) ||
      !std::isfinite(observation.total_ms)) {
    return InvalidArgument("observation", "holds a number that is not finite");
  }
  return Status::Ok();
}

Status ValidateNextSegment(const MapInfo& info, const Segment& segment, SegmentId next) {
  if (segment.id != next) {
    return InvalidArgument(
        "segment.id", "must be " + std::to_string(next) + ", not " + std::to_string(segment.id));
  }
  for (std::size_t i = 0; i < segment.path_in_map.size(); ++i) {
    if (!segment.path_in_map[i].allFinite()) {
      return InvalidArgument("path_in_map[" + std::to_string(i) + "]", "must be finite");
    }
  }
  return ValidateSegment(info, segment);
}

Status ValidateSessionEnd(SessionEnd end) {
  if (end != SessionEnd::kOpen) return Status::Ok();
  return InvalidArgument("end", "the reason of a session's end must be given (robot or idle)");
}

Status ValidatePin(const std::optional<Strategy>& pinned) {
  if (!pinned || IsSelectable(*pinned)) return Status::Ok();
  return InvalidArgument("strategy", "only 1p1l, 2p and mixed can be pinned");
}

Status EmptyMap(const MapKey& key) {
  return FailedPrecondition("EMPTY_MAP", "map '" + key.name + "' has no segment to publish");
}

Status ImportCommitted() {
  return FailedPrecondition("IMPORT_COMMITTED", "the import is published already");
}

Status SessionExists(const SessionId& id) {
  return Status(StatusCode::kAlreadyExists, "SESSION_EXISTS",
                "session '" + id + "' exists already");
}

Status UnknownMap(const std::string& name) {
  return NotFound("map '" + name + "'", "MAP_NOT_FOUND");
}

Status UnknownMap(const MapKey& key) {
  return NotFound("map '" + key.name + "' version " + std::to_string(key.version), "MAP_NOT_FOUND");
}

Status NoVersionEnabled(const std::string& name) {
  return Status(StatusCode::kNotFound, "MAP_NOT_FOUND",
                "map '" + name + "' has no enabled version; enable one: maploc-map enable --map " +
                    name + " --version N");
}

Status VersionEnabled(const MapKey& key) {
  return FailedPrecondition("MAP_ENABLED", "map '" + key.name + "' version " +
                                               std::to_string(key.version) +
                                               " is the enabled one; enable another one first");
}

Status VersionInUse(const MapKey& key, std::int64_t open_sessions) {
  return FailedPrecondition(
      "MAP_IN_USE", "map '" + key.name + "' version " + std::to_string(key.version) + " has " +
                        std::to_string(open_sessions) +
                        " open sessions; wait until they have ended (idle ones end by themselves)");
}

Status UnknownSegment(const MapKey& key, SegmentId id) {
  return NotFound("segment " + std::to_string(id) + " of map '" + key.name + "' version " +
                      std::to_string(key.version),
                  "SEGMENT_NOT_FOUND");
}

Status UnknownSession(const SessionId& id) {
  return NotFound("session '" + id + "'", "SESSION_NOT_FOUND");
}

}  // namespace maploc
