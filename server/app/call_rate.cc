#include "server/app/call_rate.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

#include <grpc/grpc.h>
#include <grpc/grpc_security.h>

namespace maploc {
namespace {

using Clock = std::chrono::steady_clock;

// A robot asks a few times a second; a proxy for a fleet, or a load generator, as often as the
// server answers.
constexpr double kCallsPerSecond = 10000;
constexpr double kBurst = 256;
constexpr std::size_t kForgetAbove = 10000;  // connections, of which most must be closed

// With the time in words: gRPC 1.51 sends no trailing metadata of whoever refuses here.
constexpr char kRefusal[] =
    "too many calls on this connection, more than 10000 a second; try again after 1000 ms "
    "(CALL_RATE)";

class CallRate {
 public:
  // `connection` is known by its address alone, which may come again.
  bool Admit(const grpc_auth_context* connection) {
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (buckets_.size() > kForgetAbove) Forget(now);
    Bucket& bucket = buckets_.try_emplace(connection, Bucket{kBurst, now}).first->second;
    const double seconds = std::chrono::duration<double>(now - bucket.filled).count();
    bucket = {std::min(kBurst, bucket.calls + seconds * kCallsPerSecond), now};
    if (bucket.calls < 1) return false;
    bucket.calls -= 1;
    return true;
  }

 private:
  struct Bucket {
    double calls;  // that may begin now
    Clock::time_point filled;
  };

  // Those that are full are as good as new ones.
  void Forget(Clock::time_point now) {
    // An empty bucket is full again after 26 ms, so a second is long enough.
    std::erase_if(buckets_, [now](const auto& entry) {
      return now - entry.second.filled > std::chrono::seconds(1);
    });
  }

  std::mutex mutex_;
  std::unordered_map<const grpc_auth_context*, Bucket> buckets_;
};

void Process(void* state, grpc_auth_context* connection, const grpc_metadata*, std::size_t,
             grpc_process_auth_metadata_done_cb done, void* call) {
  const bool admitted = static_cast<CallRate*>(state)->Admit(connection);
  // No metadata is consumed: the handler still needs `authorization`.
  done(call, nullptr, 0, nullptr, 0, admitted ? GRPC_STATUS_OK : GRPC_STATUS_RESOURCE_EXHAUSTED,
       admitted ? nullptr : kRefusal);
}

class Limited final : public grpc::ServerCredentials {
 public:
  explicit Limited(grpc_server_credentials* transport) : transport_(transport) {
    grpc_server_credentials_set_auth_metadata_processor(
        transport_,
        {Process, [](void* state) { delete static_cast<CallRate*>(state); }, new CallRate});
  }
  ~Limited() override { grpc_server_credentials_release(transport_); }
  // Nothing, because another processor would replace the limit.
  void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>&) override {}

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override {
    return grpc_server_add_http2_port(server, address.c_str(), transport_);
  }

  grpc_server_credentials* const transport_;
};

}  // namespace

std::shared_ptr<grpc::ServerCredentials> LimitedCredentials(grpc_server_credentials* transport) {
  return std::make_shared<Limited>(transport);
}

}  // namespace maploc
