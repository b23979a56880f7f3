#include "client/api/client.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <random>
#include <sstream>
#include <thread>

#include <grpcpp/grpcpp.h>

#include "client/api/credentials.h"
#include "client/api/proxy.h"
#include "client/api/remote_from_proto.h"
#include "maploc/v1/localization_service.grpc.pb.h"
#include "maploc/v1/map_service.grpc.pb.h"
#include "mapstore/base/name.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

// The service's UPPER_SNAKE reason, in the trailing metadata; faults that gRPC itself reports have
// none.
constexpr char kReasonKey[] = "maploc-reason";

// gRFC A6: the milliseconds after which a refused call is to be made again.
constexpr char kPushbackKey[] = "grpc-retry-pushback-ms";

// A server that starts again is found within seconds, not after gRPC's default of up to two
// minutes.
constexpr int kFirstReconnectMs = 100;
constexpr int kMaxReconnectMs = 2000;
// What gRPC calls the least reconnect backoff is the time that one attempt to connect may take: a
// busy server, or one behind a mobile network, needs its time.
constexpr int kConnectMs = 5000;

constexpr std::chrono::milliseconds kFirstBackoff(100);  // doubles an attempt
// A server that asks for a longer wait is not waited for: its refusal is returned.
constexpr std::chrono::milliseconds kLongestWait(2000);
constexpr std::chrono::milliseconds kCallRateWait(1000);

std::shared_ptr<grpc::ChannelCredentials> Transport(const ClientCredentials& credentials) {
  if (credentials.ca_pem.empty()) return grpc::InsecureChannelCredentials();
  return grpc::SslCredentials({credentials.ca_pem, credentials.key_pem, credentials.cert_pem});
}

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& server,
                                           const ClientCredentials& credentials) {
  grpc::ChannelArguments arguments;
  // Else gRPC lets all clients of a process share one connection, and its flow control.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kFirstReconnectMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectMs);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectMs);
  // A proxy cannot reach this machine's own loopback.
  if (IsLoopback(server)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(server, Transport(credentials), arguments);
}

StatusCode CodeFromGrpc(grpc::StatusCode code) {
  // Codes that maploc does not use (UNKNOWN, OUT_OF_RANGE) come from gRPC alone, of a broken
  // server.
  if (code == grpc::StatusCode::UNKNOWN || code == grpc::StatusCode::OUT_OF_RANGE) {
    return StatusCode::kInternal;
  }
  return static_cast<StatusCode>(code);
}

// The service repeats its reason behind the message, for tools that show nothing else.
std::string WithoutSuffix(std::string text, std::string_view suffix) {
  if (text.ends_with(suffix)) text.resize(text.size() - suffix.size());
  return text;
}

// What gRPC itself says when a connection cannot be made, or an answer does not come in time, names
// neither the proxy in between nor the time.
std::string Explain(const grpc::Status& status, const std::string& server, bool encrypted,
                    std::chrono::milliseconds timeout) {
  std::string text = "server " + server + ": " + status.error_message();
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) {
    std::ostringstream seconds;
    seconds << std::chrono::duration<double>(timeout).count();
    text += " (no answer within " + seconds.str() + " s)";
  }
  const bool unreachable = status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                           status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED;
  const std::string proxy = unreachable ? ProxyInUse(server) : "";
  if (proxy.empty() && status.error_code() == grpc::StatusCode::UNAVAILABLE) {
    text += "; is maploc-server running there? ";
    text += encrypted ? "Does its certificate fit --ca and the host?" : "With TLS it needs --ca";
  }
  if (!proxy.empty()) {
    text += "; the call went through the proxy " + proxy +
            ", put the host into no_proxy to reach it directly";
  }
  return text;
}

// A connection with too many calls is refused where gRPC sends no trailing metadata: then the text
// alone says so.
bool IsCallRate(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED &&
         status.error_message().ends_with(" (CALL_RATE)");
}

Status StatusFromGrpc(const grpc::Status& status, const grpc::ClientContext& context,
                      const std::string& server, const ClientOptions& options) {
  if (status.ok()) return Status::Ok();
  const StatusCode code = CodeFromGrpc(status.error_code());
  const auto& trailer = context.GetServerTrailingMetadata();
  const auto reason = trailer.find(kReasonKey);
  if (reason != trailer.end()) {
    std::string name(reason->second.data(), reason->second.size());
    std::string message = WithoutSuffix(status.error_message(), " (" + name + ")");
    return Status(code, std::move(name), std::move(message));
  }
  const std::string_view name = IsCallRate(status) ? "CALL_RATE" : StatusCodeName(code);
  return Status(code, std::string(name),
                Explain(status, server, !options.credentials.ca_pem.empty(), options.call_timeout));
}

// Unique over robots and restarts, which no seed handed in could promise.
std::string NewRequestId() {
  std::random_device entropy;
  std::string id;
  for (int i = 0; i < 4; ++i) {
    char word[9];
    std::snprintf(word, sizeof(word), "%08x", static_cast<unsigned>(entropy()));
    id += word;
  }
  return id;
}

// The server sends it with a call that it refused before it began, so that a repetition is safe
// whatever was called. Nullopt where it does not stand, or is no number of milliseconds.
std::optional<std::chrono::milliseconds> Pushback(const grpc::ClientContext& context) {
  const auto& trailer = context.GetServerTrailingMetadata();
  const auto pushback = trailer.find(kPushbackKey);
  if (pushback == trailer.end()) return std::nullopt;
  const char* const end = pushback->second.data() + pushback->second.size();
  std::int32_t wait_ms = -1;
  const auto [parsed, error] = std::from_chars(pushback->second.data(), end, wait_ms);
  if (error != std::errc() || parsed != end || wait_ms < 0) return std::nullopt;
  return std::chrono::milliseconds(wait_ms);
}

// Robots that were refused together must not come back together: up to a quarter more.
std::chrono::milliseconds WithJitter(std::chrono::milliseconds wait) {
  std::random_device entropy;
  return wait + wait * (entropy() % 256) / 1024;
}

// Callers index their features with what came over the wire.
Status CheckMatches(const Localization& answer, const Query& query) {
  const auto outside = [](const std::vector<FeatureMatch>& matches, std::size_t features) {
    return std::ranges::any_of(matches, [features](const FeatureMatch& match) {
      return match.feature < 0 || static_cast<std::size_t>(match.feature) >= features;
    });
  };
  const View& view = query.views.front();
  if (outside(answer.matches.points, view.points.keypoints_px.size()) ||
      outside(answer.matches.lines, view.lines.starts_px.size())) {
    return Internal("the server's answer matches a feature that was not sent");
  }
  return Status::Ok();
}

}  // namespace

struct Client::Impl {
  Impl(const std::string& server_name, const ClientOptions& client_options)
      : server(server_name),
        options(client_options),
        channel(MakeChannel(server_name, client_options.credentials)),
        localization(v1::LocalizationService::NewStub(channel)),
        maps(v1::MapService::NewStub(channel)) {}

  // How long to wait before a failed call is made again; nullopt: it is not.
  static std::optional<std::chrono::milliseconds> Wait(const grpc::Status& status,
                                                       const grpc::ClientContext& context,
                                                       std::chrono::milliseconds backoff) {
    if (status.ok()) return std::nullopt;
    if (const auto pushback = Pushback(context)) {
      const auto wait = std::max(*pushback, backoff);
      return *pushback <= kLongestWait ? std::optional(WithJitter(wait)) : std::nullopt;
    }
    if (IsCallRate(status)) return WithJitter(std::max(kCallRateWait, backoff));
    const bool again = status.error_code() == grpc::StatusCode::UNAVAILABLE;
    return again ? std::optional(WithJitter(backoff)) : std::nullopt;
  }

  // Whoever reads it on its way has it.
  Status CheckToken() const {
    const ClientCredentials& own = options.credentials;
    if (own.token.empty()) return Status::Ok();
    MAPLOC_RETURN_IF_ERROR(CheckTokenText("token", own.token));
    if (!own.ca_pem.empty() || IsLoopback(server)) return Status::Ok();
    return FailedPrecondition(
        "TOKEN_IN_CLEAR", "the token is not sent to " + server + " without encryption; give --ca");
  }

  // Calls `method`, again where that may help, until the call's time is over. REQUIRES: the call
  // is safe to repeat.
  template <typename Stub, typename Request, typename Response>
  Status Call(Stub& stub,
              grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
              const Request& request, Response* response) const {
    MAPLOC_RETURN_IF_ERROR(CheckToken());
    const auto deadline = std::chrono::system_clock::now() + options.call_timeout;
    auto backoff = kFirstBackoff;
    for (int attempt = 1;; ++attempt) {
      // A context is for one call: each attempt needs its own.
      grpc::ClientContext context;
      context.set_deadline(deadline);
      if (const std::string& token = options.credentials.token; !token.empty()) {
        context.AddMetadata("authorization", "Bearer " + token);
      }
      const grpc::Status status = (stub.*method)(&context, request, response);
      const auto wait = Wait(status, context, backoff);
      // A wait that would outlast the deadline is not begun: the refusal says more than a timeout.
      const bool again = wait && attempt < options.max_attempts &&
                         std::chrono::system_clock::now() + *wait < deadline;
      if (!again) return StatusFromGrpc(status, context, server, options);
      std::this_thread::sleep_for(*wait);
      backoff *= 2;
    }
  }

  Result<SessionSummary> EndSession(const SessionId& session, bool discard) const {
    MAPLOC_RETURN_IF_ERROR(CheckName("session_id", session));
    v1::EndSessionRequest request;
    request.set_session_id(session);
    request.set_discard(discard);
    v1::EndSessionResponse response;
    MAPLOC_RETURN_IF_ERROR(
        Call(*localization, &v1::LocalizationService::Stub::EndSession, request, &response));
    return SessionSummaryFromProto(response, session);
  }

  const std::string server;
  const ClientOptions options;
  const std::shared_ptr<grpc::Channel> channel;
  const std::unique_ptr<v1::LocalizationService::Stub> localization;
  const std::unique_ptr<v1::MapService::Stub> maps;
};

Client::Client(const std::string& server, const ClientOptions& options)
    : impl_(std::make_unique<Impl>(server, options)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

const std::string& Client::server() const { return impl_->server; }

Result<std::vector<RemoteMap>> Client::ListMaps() const {
  v1::ListMapsResponse response;
  MAPLOC_RETURN_IF_ERROR(
      impl_->Call(*impl_->maps, &v1::MapService::Stub::ListMaps, v1::ListMapsRequest(), &response));
  std::vector<RemoteMap> maps;
  for (const v1::Map& map : response.maps()) {
    MAPLOC_ASSIGN_OR_RETURN(maps.emplace_back(), RemoteMapFromProto(map));
  }
  return maps;
}

Result<RemoteMap> Client::GetMap(const std::string& map) const {
  MAPLOC_RETURN_IF_ERROR(CheckName("map", map));
  v1::GetMapRequest request;
  request.set_map(map);
  v1::GetMapResponse response;
  MAPLOC_RETURN_IF_ERROR(
      impl_->Call(*impl_->maps, &v1::MapService::Stub::GetMap, request, &response));
  return RemoteMapFromProto(response.map());
}

Result<std::vector<RemoteSegment>> Client::ListSegments(const std::string& map) const {
  MAPLOC_RETURN_IF_ERROR(CheckName("map", map));
  v1::ListSegmentsRequest request;
  request.set_map(map);
  v1::ListSegmentsResponse response;
  MAPLOC_RETURN_IF_ERROR(
      impl_->Call(*impl_->maps, &v1::MapService::Stub::ListSegments, request, &response));
  std::vector<RemoteSegment> segments;
  for (const v1::Segment& segment : response.segments()) {
    MAPLOC_ASSIGN_OR_RETURN(segments.emplace_back(), RemoteSegmentFromProto(segment));
  }
  return segments;
}

Result<RemoteSegment> Client::GetSegment(const std::string& map, SegmentId id) const {
  MAPLOC_RETURN_IF_ERROR(CheckName("map", map));
  v1::GetSegmentRequest request;
  request.set_map(map);
  request.set_segment_id(id);
  v1::GetSegmentResponse response;
  MAPLOC_RETURN_IF_ERROR(
      impl_->Call(*impl_->maps, &v1::MapService::Stub::GetSegment, request, &response));
  return RemoteSegmentFromProto(response.segment());
}

Result<SessionId> Client::StartSession(const std::string& map, const std::string& robot,
                                       const std::map<std::string, std::string>& labels,
                                       std::int64_t map_version) const {
  MAPLOC_RETURN_IF_ERROR(CheckName("map", map));
  MAPLOC_RETURN_IF_ERROR(CheckName("robot", robot));
  for (const auto& [key, value] : labels) {
    MAPLOC_RETURN_IF_ERROR(CheckName("labels", key));
    MAPLOC_RETURN_IF_ERROR(CheckName("labels." + key, value));
  }
  v1::StartSessionRequest request;
  request.set_map(map);
  request.set_robot(robot);
  request.mutable_labels()->insert(labels.begin(), labels.end());
  request.set_request_id(NewRequestId());
  request.set_map_version(map_version);
  v1::StartSessionResponse response;
  MAPLOC_RETURN_IF_ERROR(impl_->Call(
      *impl_->localization, &v1::LocalizationService::Stub::StartSession, request, &response));
  return response.session_id();
}

Result<Localization> Client::Localize(const Query& query, bool include_matches) const {
  MAPLOC_RETURN_IF_ERROR(CheckName("map", query.map));
  MAPLOC_RETURN_IF_ERROR(CheckName("session_id", query.session));
  MAPLOC_RETURN_IF_ERROR(CheckName("request_id", query.request_id));
  // CheckMatches looks at the view, also where a broken server answers a query without one.
  if (query.views.empty()) return InvalidArgument("views", "one view is required", "REQUIRED");
  v1::LocalizeRequest request;
  QueryToProto(query, include_matches, &request);
  // A lost answer does not tell whether the query was counted: by its id it is so once.
  if (!query.session.empty() && query.request_id.empty()) request.set_request_id(NewRequestId());
  v1::LocalizeResponse response;
  MAPLOC_RETURN_IF_ERROR(impl_->Call(*impl_->localization, &v1::LocalizationService::Stub::Localize,
                                     request, &response));
  MAPLOC_ASSIGN_OR_RETURN(Localization answer, LocalizationFromProto(response, query.map));
  MAPLOC_RETURN_IF_ERROR(CheckMatches(answer, query));
  return answer;
}

Result<SessionSummary> Client::EndSession(const SessionId& session) const {
  return impl_->EndSession(session, /*discard=*/false);
}

Result<SessionSummary> Client::DiscardSession(const SessionId& session) const {
  return impl_->EndSession(session, /*discard=*/true);
}

}  // namespace maploc
