// Limits the calls of a connection, and of all, that the server has begun and not dropped. HTTP/2's
// limit of concurrent streams does not do that: a stream that its client resets at once counts no
// more, but the server still works at it ("rapid reset"), and gRPC 1.51 reads on meanwhile.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <grpcpp/support/server_interceptor.h>

namespace maploc {

// What a connection may have open, as clients are told; they wait with more.
inline constexpr int kMaxStreams = 64;

// Thread-safe.
class CallLimit final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  using OfPeer = std::function<void(const std::string& peer)>;

  // `arrived` hears of each call's peer (grpc::ServerContext::peer()). `abort` ends the connection
  // of a peer that has too many calls, which no client reaches that keeps to kMaxStreams; or, where
  // all together have too many, of the peer that has the most. Called by gRPC's threads.
  CallLimit(OfPeer arrived, OfPeer abort);
  ~CallLimit() override;

  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* info) override;

 private:
  class Calls;
  class Counted;

  std::shared_ptr<Calls> calls_;
};

}  // namespace maploc
