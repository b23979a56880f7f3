// The tokens of a store: STORE-tokens beside it, readable by its owner alone (README.md says why it
// is no table). One JSON object a line, each appended and never changed: a token that was created,
// or one that was revoked. Writers lock the file; a reader takes whole lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "mapstore/base/status.h"
#include "server/access/caller.h"
#include "server/access/token.h"

namespace maploc {

struct TokenRecord {
  Grant grant;
  std::string hash;  // HashSecret
  std::int64_t created_unix_ns = 0;
  std::optional<std::int64_t> expires_unix_ns;  // from then on it is refused; none: never
  std::optional<std::int64_t> revoked_unix_ns;
};

using TokenRecords = std::map<std::string, TokenRecord>;  // by id

class TokenFile {
 public:
  explicit TokenFile(const std::string& store_path);

  const std::string& path() const { return path_; }

  // Nullopt: there is no file, so no token was ever created. INVALID_ARGUMENT (INVALID_FILE, with
  // the line) or UNAVAILABLE (TOKENS_UNREADABLE).
  Result<std::optional<TokenRecords>> Read() const;

  // A new token, whose secret is in the answer alone. The file is made where there is none, and
  // belongs to whom the store's folder does. `lifetime` is from now on; none: for ever.
  // INVALID_ARGUMENT: a name that is none; a robot without a name. Else Read's errors, and
  // UNAVAILABLE (TOKENS_NOT_WRITTEN): nothing has changed.
  Result<Token> Create(const Grant& grant,
                       std::optional<std::chrono::seconds> lifetime = std::nullopt) const;

  // Idempotent. NOT_FOUND (TOKEN_NOT_FOUND); else Create's errors.
  Status Revoke(const std::string& id) const;

 private:
  const std::string path_;
};

}  // namespace maploc
