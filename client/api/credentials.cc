#include "client/api/credentials.h"

#include <algorithm>

#include "mapstore/base/small_file.h"

namespace maploc {
namespace {

constexpr char kReason[] = "CREDENTIALS_INVALID";
constexpr std::size_t kMaxTokenBytes = 4096;

Status Refuse(const std::string& what, const std::string& why) {
  return InvalidArgument(what, why, kReason);
}

// gRPC's word for a file that is no PEM is that the server cannot be reached.
Result<std::string> ReadPem(const std::string& path, const char* what) {
  if (path.empty()) return std::string();
  MAPLOC_ASSIGN_OR_RETURN(std::string pem, ReadSmallFile(path, kReason));
  const std::size_t begin = pem.find("-----BEGIN ");
  const std::string line = pem.substr(std::min(begin, pem.size()), 64);
  // Anywhere in the line, because keys also begin with BEGIN EC PRIVATE KEY and the like.
  if (line.find(what) != std::string::npos) return pem;
  return Refuse(path, std::string("holds no PEM that begins with BEGIN ") + what);
}

Result<std::string> ReadToken(const std::string& path) {
  if (path.empty()) return std::string();
  MAPLOC_ASSIGN_OR_RETURN(std::string token, ReadSmallFile(path, kReason));
  // Editors and echo end the line.
  while (token.ends_with('\n') || token.ends_with('\r')) token.pop_back();
  MAPLOC_RETURN_IF_ERROR(CheckTokenText(path, token));
  return token;
}

}  // namespace

Status CheckTokenText(const std::string& source, const std::string& token) {
  const bool printable = std::ranges::all_of(token, [](char c) { return c > ' ' && c <= '~'; });
  if (printable && !token.empty() && token.size() <= kMaxTokenBytes) return Status::Ok();
  return Refuse(source,
                "holds no token; it must be the line that maploc-server token create prints");
}

Result<ClientCredentials> ReadCredentials(const CredentialFiles& files) {
  if (files.cert.empty() != files.key.empty()) {
    return Refuse("--cert", "a certificate and its key come together; give --cert and --key");
  }
  if (files.ca.empty() && !files.cert.empty()) {
    return Refuse("--cert", "is of no use without TLS; give --ca");
  }
  ClientCredentials credentials;
  MAPLOC_ASSIGN_OR_RETURN(credentials.ca_pem, ReadPem(files.ca, "CERTIFICATE"));
  MAPLOC_ASSIGN_OR_RETURN(credentials.cert_pem, ReadPem(files.cert, "CERTIFICATE"));
  MAPLOC_ASSIGN_OR_RETURN(credentials.key_pem, ReadPem(files.key, "PRIVATE KEY"));
  MAPLOC_ASSIGN_OR_RETURN(credentials.token, ReadToken(files.token));
  return credentials;
}

}  // namespace maploc
