// What the server proves itself with, and whom it believes: PEM files, read and checked as a whole,
// so that a wrong file is refused by its name and not by a handshake that nobody understands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapstore/base/status.h"

namespace maploc {

struct TlsFiles {
  std::string cert;       // the server's certificate, then those between it and its authority
  std::string key;        // its private key, not encrypted
  std::string client_ca;  // authorities of the clients' certificates; empty: none is asked for
};

// The same as text.
struct TlsMaterial {
  std::string cert_chain_pem;
  std::string key_pem;
  std::string client_ca_pem;
  std::int64_t end_unix_s = 0;  // until when the certificate is valid
};

// INVALID_ARGUMENT with the file, the cause and the cure: TLS_FILE_UNREADABLE (1 MiB at most);
// TLS_FILE_INVALID (no certificate, no key, an encrypted key); TLS_KEY_MISMATCH;
// TLS_CERTIFICATE_EXPIRED (also one that is not valid yet, and clients' authorities of which
// none is valid). No message holds what a file holds.
// Thread-safe.
Result<TlsMaterial> ReadTlsMaterial(const TlsFiles& files);
// Every fault for which ReadTlsMaterial refuses the files, not only the first.
std::vector<Status> FindTlsFaults(const TlsFiles& files);

}  // namespace maploc
