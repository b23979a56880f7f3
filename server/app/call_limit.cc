#include "server/app/call_limit.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>

#include <grpcpp/server_context.h>
#include <spdlog/spdlog.h>

#include "server/app/seldom.h"

namespace maploc {
namespace {

// Twice as many may be there when a client cancels all its calls and makes new ones.
constexpr std::size_t kMaxOfPeer = 4 * kMaxStreams;
// A call costs gRPC some 15 KB.
constexpr std::size_t kMaxOfAll = 8192;

}  // namespace

class CallLimit::Calls {
 public:
  Calls(OfPeer arrived, OfPeer abort) : arrived_(std::move(arrived)), abort_(std::move(abort)) {}

  void Begin(const std::string& peer) {
    arrived_(peer);
    if (const std::optional<std::string> greedy = Count(peer)) abort_(*greedy);
  }
  void End(const std::string& peer) {
    const std::lock_guard lock(mutex_);
    --all_;
    const auto found = of_peer_.find(peer);
    if (--found->second == 0) of_peer_.erase(found);
  }

 private:
  // The peer that is to go.
  std::optional<std::string> Count(const std::string& peer) {
    const std::lock_guard lock(mutex_);
    ++all_;
    // Once, at the step over the limit: the connection takes a moment to end, and its calls still
    // come.
    if (++of_peer_[peer] == kMaxOfPeer + 1) return Tell(peer), peer;
    if (all_ <= kMaxOfAll) return std::nullopt;
    const auto most =
        std::ranges::max_element(of_peer_, {}, [](const auto& entry) { return entry.second; });
    // Those that are over their own limit are on their way out.
    if (most->second > kMaxOfPeer) return std::nullopt;
    return Tell(most->first), most->first;
  }
  void Tell(const std::string& peer) {
    if (told_.IsTime()) spdlog::warn("connections are ended: {} has too many calls", peer);
  }

  const OfPeer arrived_;
  const OfPeer abort_;
  std::mutex mutex_;
  Seldom told_;
  std::unordered_map<std::string, std::size_t> of_peer_;
  std::size_t all_ = 0;
};

// Lives as long as gRPC has the call.
class CallLimit::Counted final : public grpc::experimental::Interceptor {
 public:
  Counted(std::shared_ptr<Calls> calls, std::string peer)
      : calls_(std::move(calls)), peer_(std::move(peer)) {
    calls_->Begin(peer_);
  }
  ~Counted() override { calls_->End(peer_); }
  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    methods->Proceed();
  }

 private:
  const std::shared_ptr<Calls> calls_;
  const std::string peer_;
};

CallLimit::CallLimit(OfPeer arrived, OfPeer abort)
    : calls_(std::make_shared<Calls>(std::move(arrived), std::move(abort))) {}

CallLimit::~CallLimit() = default;

grpc::experimental::Interceptor* CallLimit::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  return new Counted(calls_, info->server_context()->peer());
}

}  // namespace maploc
