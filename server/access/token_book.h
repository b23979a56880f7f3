// The tokens as a running server knows them: a token that was created or revoked is so within a
// second (kLookEvery), without a restart. Thread-safe.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "mapstore/base/status.h"
#include "mapstore/store/file_state.h"
#include "server/access/caller.h"
#include "server/access/token_file.h"

namespace maploc {

class TokenBook {
 public:
  static constexpr std::chrono::milliseconds kLookEvery{100};

  // Callers are asked for a token where `always_asked`, and as soon as the store has a file of
  // tokens; from then on always, also when all are revoked or the file is gone. Errors are
  // TokenFile::Read's.
  static Result<std::unique_ptr<TokenBook>> Open(const std::string& store_path, bool always_asked);

  // Nobody can call before one is created.
  bool IsAskedInVain();

  // `authorization` is the call's header: "Bearer TOKEN"; nullopt: it has none. UNAUTHENTICATED:
  // TOKEN_MISSING, TOKEN_MALFORMED, TOKEN_WRONG, TOKEN_REVOKED, TOKEN_EXPIRED. No message holds the
  // token. A file that cannot be read any more is told in the log, and what was known counts on:
  // `token revoke` refuses to write to such a file, so that nobody takes a token for revoked that
  // is not.
  Result<Caller> Authenticate(std::optional<std::string_view> authorization);

 private:
  using Known = std::shared_ptr<const TokenRecords>;

  TokenBook(const std::string& store_path, bool always_asked);
  // Null: nobody is asked.
  Known Look();
  // REQUIRES: mutex_ is held, or nobody else knows the book yet.
  Status Reload();

  const TokenFile file_;
  std::mutex mutex_;  // guards all below
  Known known_;
  bool had_file_ = false;
  std::optional<std::optional<FileState>> seen_;  // none: to be read in any case
  std::string told_;                              // the failure that the log has, once
  std::chrono::steady_clock::time_point next_look_;
};

}  // namespace maploc
