// Credentials that let a connection begin so many calls and no more. What is refused here costs
// gRPC little: it is dropped before the server hears of it, in the thread that reads the
// connection. Calls that are begun and reset at once ("rapid reset") cannot pile up, which they
// otherwise do: gRPC 1.51 reads on while the calls wait for threads.
#pragma once

#include <memory>

#include <grpc/grpc_security.h>
#include <grpcpp/security/server_credentials.h>

namespace maploc {

// Those of `transport`, which it takes: what encrypts a connection and says who the peer is.
std::shared_ptr<grpc::ServerCredentials> LimitedCredentials(grpc_server_credentials* transport);

}  // namespace maploc
