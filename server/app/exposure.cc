#include "server/app/exposure.h"

#include "server/app/listening_sockets.h"

namespace maploc {
namespace {

bool IsExposed(const ServerOptions& options) {
  return IsBeyondLoopback(options.listen) && !options.insecure;
}

}  // namespace

Status CheckExposure(const ServerOptions& options) {
  if (!options.tls.cert.empty() || !IsExposed(options)) return Status::Ok();
  return InvalidArgument("--listen",
                         options.listen +
                             " can be reached from other machines, and nothing is encrypted; give "
                             "--tls-cert and --tls-key, listen on 127.0.0.1, or say --insecure",
                         "INSECURE");
}

bool NeedsTokens(const ServerOptions& options) {
  // A client's certificate says already who may come.
  return IsExposed(options) && options.tls.client_ca.empty();
}

}  // namespace maploc
