#include "server/app/tls_credentials.h"

#include <utility>

#include <spdlog/spdlog.h>

namespace maploc {

TlsCredentials::TlsCredentials(TlsFiles files, std::int64_t certificate_end_unix_s)
    : files_(std::move(files)), certificate_end_unix_s_(certificate_end_unix_s) {}

Result<std::unique_ptr<TlsCredentials>> TlsCredentials::Open(const TlsFiles& files) {
  MAPLOC_ASSIGN_OR_RETURN(const TlsMaterial material, ReadTlsMaterial(files));
  return std::unique_ptr<TlsCredentials>(new TlsCredentials(files, material.end_unix_s));
}

grpc_server_credentials* TlsCredentials::New() {
  {
    const std::lock_guard lock(mutex_);
    seen_.reset();  // gRPC asks at once, for a server that has nothing yet
  }
  return grpc_ssl_server_credentials_create_with_options(
      grpc_ssl_server_credentials_create_options_using_config_fetcher(
          files_.client_ca.empty() ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                                   : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY,
          Fetch, this));
}

std::optional<TlsMaterial> TlsCredentials::Changed() {
  const std::lock_guard lock(mutex_);
  // Before the files are read: a change in between is seen the next time.
  const States states{FileState::Of(files_.cert), FileState::Of(files_.key),
                      FileState::Of(files_.client_ca)};
  if (states == seen_) return std::nullopt;
  Result<TlsMaterial> material = ReadTlsMaterial(files_);
  if (!material.ok()) {
    // Not noted as seen: permissions and the clock may make the same files good, and no state tells
    // either. They are then read for each connection, and told once.
    const std::string refusal = material.status().ToString();
    if (std::exchange(told_, refusal) != refusal) {
      spdlog::warn("new TLS files are not used, the ones before are: {}", refusal);
    }
    return std::nullopt;
  }
  told_.clear();
  const bool first = !std::exchange(seen_, states).has_value();
  certificate_end_unix_s_ = material->end_unix_s;
  if (!first) spdlog::info("new connections get the new certificate in {}", files_.cert);
  return *std::move(material);
}

grpc_ssl_certificate_config_reload_status TlsCredentials::Fetch(
    void* credentials, grpc_ssl_server_certificate_config** config) {
  const std::optional<TlsMaterial> material = static_cast<TlsCredentials*>(credentials)->Changed();
  if (!material) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
  const grpc_ssl_pem_key_cert_pair pair{material->key_pem.c_str(),
                                        material->cert_chain_pem.c_str()};
  // gRPC 1.51 insists on authorities; where no client is asked, nobody looks at them.
  const std::string& authorities =
      material->client_ca_pem.empty() ? material->cert_chain_pem : material->client_ca_pem;
  *config = grpc_ssl_server_certificate_config_create(authorities.c_str(), &pair, 1);
  return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
}

}  // namespace maploc
