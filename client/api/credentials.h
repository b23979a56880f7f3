// A client's credentials from the files in which they are kept.
#pragma once

#include <string>

#include "client/api/client.h"
#include "mapstore/base/status.h"

namespace maploc {

// Paths; empty: none.
struct CredentialFiles {
  std::string ca;
  std::string cert;
  std::string key;
  std::string token;
};

// INVALID_ARGUMENT with the file's path: CREDENTIALS_INVALID for one that cannot be read (1 MiB at
// most), that is not PEM, or whose token is not one line of printable ASCII; and where certificate
// and key do not come together, or without a CA. No message holds what a file holds. Thread-safe.
Result<ClientCredentials> ReadCredentials(const CredentialFiles& files);

// What a token may look like in a call's header: printable ASCII without spaces, at most 4096
// bytes. `source` says where it came from.
Status CheckTokenText(const std::string& source, const std::string& token);

}  // namespace maploc
