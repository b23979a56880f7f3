// One handler an RPC, each in its own file: translate, check, delegate, answer. They know messages
// but not gRPC; the service calls them on its threads. Errors are those of the .proto's comments.
#pragma once

#include "maploc/v1/localization_service.pb.h"
#include "maploc/v1/map_service.pb.h"
#include "mapstore/base/status.h"
#include "server/service/service_context.h"

namespace maploc {

Status HandleStartSession(const ServiceContext& context, const Call& call,
                          const v1::StartSessionRequest& request,
                          v1::StartSessionResponse* response);
Status HandleLocalize(const ServiceContext& context, const Call& call,
                      const v1::LocalizeRequest& request, v1::LocalizeResponse* response);
Status HandleEndSession(const ServiceContext& context, const Call& call,
                        const v1::EndSessionRequest& request, v1::EndSessionResponse* response);

Status HandleListMaps(const ServiceContext& context, const Call& call,
                      const v1::ListMapsRequest& request, v1::ListMapsResponse* response);
Status HandleGetMap(const ServiceContext& context, const Call& call,
                    const v1::GetMapRequest& request, v1::GetMapResponse* response);
Status HandleListSegments(const ServiceContext& context, const Call& call,
                          const v1::ListSegmentsRequest& request,
                          v1::ListSegmentsResponse* response);
Status HandleGetSegment(const ServiceContext& context, const Call& call,
                        const v1::GetSegmentRequest& request, v1::GetSegmentResponse* response);

}  // namespace maploc
