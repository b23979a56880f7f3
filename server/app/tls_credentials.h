// TLS for the server's connections. The files are looked at for each new connection: a renewed
// certificate is served without a restart, and open connections stay.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <grpc/grpc_security.h>

#include "mapstore/base/status.h"
#include "mapstore/store/file_state.h"
#include "server/app/tls_material.h"

namespace maploc {

// Thread-safe.
class TlsCredentials {
 public:
  // Errors are ReadTlsMaterial's.
  static Result<std::unique_ptr<TlsCredentials>> Open(const TlsFiles& files);

  // TLS 1.2 or newer; with `files.client_ca` a client without a certificate of these authorities
  // gets no connection. The caller releases it. REQUIRES: this object outlives the last connection
  // that is accepted with it.
  grpc_server_credentials* New();
  // Until when the certificate in use is valid, Unix time.
  std::int64_t certificate_end_unix_s() const { return certificate_end_unix_s_; }

 private:
  using States = std::array<std::optional<FileState>, 3>;

  TlsCredentials(TlsFiles files, std::int64_t certificate_end_unix_s);
  static grpc_ssl_certificate_config_reload_status Fetch(
      void* credentials, grpc_ssl_server_certificate_config** config);
  // What is new since the last call; nullopt: nothing that fits. New files that do not (a renewal
  // that is half done) are told in the log, the ones before serve on, and the new ones are tried
  // again with the next connection.
  std::optional<TlsMaterial> Changed();

  const TlsFiles files_;
  std::atomic<std::int64_t> certificate_end_unix_s_;
  std::mutex mutex_;
  std::optional<States> seen_;  // of the files in use
  std::string told_;            // the refusal that the log has, once
};

}  // namespace maploc
