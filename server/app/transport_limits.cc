#include "server/app/transport_limits.h"

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>

#include "server/app/call_limit.h"

namespace maploc {
namespace {

// The store's connections, its log, the port file, gRPC's own; 17 are usual.
constexpr std::size_t kOwnDescriptors = 64;
constexpr std::size_t kMaxConnections = 8192;
constexpr std::size_t kLeastConnections = 8;

// The last resort: before other calls gRPC gives up connections that have none at the moment.
constexpr std::size_t kMaxTransportBytes = 192 << 20;

// gRPC handles all that one read brings before it looks at anything else: by default 4 MB, which
// may begin and reset 20,000 calls.
constexpr int kMaxReadBytes = 64 << 10;

constexpr int kMs = 1000;
// A peer that does not answer a ping is gone after 50 s at most.
constexpr int kPingEveryMs = 30 * kMs;
constexpr int kPongWithinMs = 20 * kMs;
// A client's pings are welcome; more often than this they are an attack.
constexpr int kLeastPingIntervalMs = 5 * kMs;
// From the connection to the client's first HTTP/2 settings.
constexpr int kHandshakeWithinMs = 20 * kMs;
// A client that has asked nothing connects again by itself with its next question.
constexpr int kIdleMs = 15 * 60 * kMs;

}  // namespace

void RaiseDescriptorLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

std::size_t MaxConnections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return kLeastConnections;
  const std::size_t descriptors = std::max<std::size_t>(limit.rlim_cur, kOwnDescriptors);
  return std::clamp(descriptors - kOwnDescriptors, kLeastConnections, kMaxConnections);
}

void LimitTransport(Connections* connections, grpc::ServerBuilder* builder) {
  grpc::ResourceQuota quota("maploc-server");
  quota.Resize(kMaxTransportBytes);
  builder->SetResourceQuota(quota);
  for (const auto& [argument, value] : std::initializer_list<std::pair<const char*, int>>{
           {GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxStreams},
           {GRPC_ARG_TCP_MAX_READ_CHUNK_SIZE, kMaxReadBytes},
           {GRPC_ARG_KEEPALIVE_TIME_MS, kPingEveryMs},
           {GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kPongWithinMs},
           {GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1},
           {GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0},  // no limit of ours
           {GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kLeastPingIntervalMs},
           {GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeWithinMs},
           {GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMs}}) {
    builder->AddChannelArgument(argument, value);
  }
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors;
  interceptors.push_back(std::make_unique<CallLimit>(
      [connections](const std::string& peer) { connections->NoteCall(peer); },
      [connections](const std::string& peer) { connections->Abort(peer); }));
  builder->experimental().SetInterceptorCreators(std::move(interceptors));
}

}  // namespace maploc
