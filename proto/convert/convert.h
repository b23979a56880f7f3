// Wire <-> domain. The only parser at the door: what comes out of a FromProto here is valid, and
// nobody checks again. Errors are INVALID_ARGUMENT and start with the field's path as it stands in
// the .proto ("views[0].points.coordinates_pixels[12]"); more features than kMaxFeatures are
// RESOURCE_EXHAUSTED. Every count is bounded before anything is allocated. Pure; thread-safe.
#pragma once

#include <map>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/map.h"
#include "mapstore/model/query.h"
#include "mapstore/model/session.h"

namespace maploc::v1 {
class DescriptorKind;
class EndSessionRequest;
class EndSessionResponse;
class LocalizeRequest;
class LocalizeResponse;
class Map;
class Rigid3;
class Segment;
class Similarity3;
class StartSessionRequest;
}  // namespace maploc::v1

namespace maploc {

inline constexpr int kMaxFeatures = 20000;  // of one kind in a view
inline constexpr int kMaxLabels = 32;

// What a robot asks for when it starts a session.
struct SessionRequest {
  std::string map;
  std::string robot;
  std::map<std::string, std::string> labels;
  std::string request_id;        // may be empty
  std::int64_t map_version = 0;  // 0: the enabled one
};

// Names: as CheckName (mapstore/base/name.h).
Result<SessionRequest> SessionRequestFromProto(const v1::StartSessionRequest& request);
Result<SessionId> SessionIdFromProto(const v1::EndSessionRequest& request);
// The field `map` of a request about one map.
Status CheckMapName(const std::string& name);

Result<Query> QueryFromProto(const v1::LocalizeRequest& request);
// REQUIRES: a valid query.
void QueryToProto(const Query& query, bool include_matches, v1::LocalizeRequest* request);

void LocalizationToProto(const Query& query, const Localization& localization, bool include_matches,
                         v1::LocalizeResponse* response);
// `map` is the name the query asked for. The matches' landmarks stay 0: the wire does not carry
// them.
Result<Localization> LocalizationFromProto(const v1::LocalizeResponse& response,
                                           const std::string& map);

void SessionSummaryToProto(const SessionSummary& summary, v1::EndSessionResponse* response);
Result<SessionSummary> SessionSummaryFromProto(const v1::EndSessionResponse& response,
                                               const SessionId& session);

Result<DescriptorKind> DescriptorKindFromProto(const v1::DescriptorKind& kind,
                                               const std::string& field);
void DescriptorKindToProto(const DescriptorKind& kind, v1::DescriptorKind* proto);
Result<Rigid3> Rigid3FromProto(const v1::Rigid3& rigid, const std::string& field);
void Rigid3ToProto(const Rigid3& rigid, v1::Rigid3* proto);
Result<Similarity3> Similarity3FromProto(const v1::Similarity3& similarity,
                                         const std::string& field);
void Similarity3ToProto(const Similarity3& similarity, v1::Similarity3* proto);

// All but the counts, which a MapInfo does not know.
void MapInfoToProto(const MapInfo& info, v1::Map* proto);
Result<MapInfo> MapInfoFromProto(const v1::Map& map);
// Strategy, ratios and counts of sessions and queries; the rest of `proto` stays.
void SegmentKnowledgeToProto(const SegmentStatistics& statistics, const StrategyDecision& decision,
                             v1::Segment* proto);

}  // namespace maploc
