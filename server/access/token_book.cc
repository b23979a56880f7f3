#include "server/access/token_book.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "mapstore/base/clock.h"
#include "server/access/token.h"

namespace maploc {
namespace {

constexpr std::string_view kScheme = "Bearer ";

Status Unauthenticated(const char* reason, const std::string& why) {
  return Status(StatusCode::kUnauthenticated, reason, why);
}

}  // namespace

TokenBook::TokenBook(const std::string& store_path, bool always_asked)
    : file_(store_path), known_(always_asked ? std::make_shared<const TokenRecords>() : nullptr) {}

Result<std::unique_ptr<TokenBook>> TokenBook::Open(const std::string& store_path,
                                                   bool always_asked) {
  std::unique_ptr<TokenBook> book(new TokenBook(store_path, always_asked));
  MAPLOC_RETURN_IF_ERROR(book->Reload());
  return book;
}

Status TokenBook::Reload() {
  // Before it is read: a change in between is seen the next time.
  const std::optional<FileState> state = FileState::Of(file_.path());
  if (seen_ && *seen_ == state) return Status::Ok();
  // A file that cannot be read is tried again at the next look, also where its state is the same.
  seen_.reset();
  MAPLOC_ASSIGN_OR_RETURN(std::optional<TokenRecords> records, file_.Read());
  if (!records && had_file_) {
    return Status(StatusCode::kUnavailable, "TOKENS_UNREADABLE",
                  file_.path() + " is gone; put it back, or make new tokens");
  }
  seen_ = state;
  if (!records) return Status::Ok();
  had_file_ = true;
  known_ = std::make_shared<const TokenRecords>(*std::move(records));
  return Status::Ok();
}

TokenBook::Known TokenBook::Look() {
  // The file is read under the lock, so that of many callers one reads it.
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return known_;
  next_look_ = now + kLookEvery;
  const Status status = Reload();
  if (!status.ok() && status.message() != told_) {
    spdlog::error("the tokens known until now stay in force: {}", status.ToString());
  }
  told_ = status.message();
  return known_;
}

bool TokenBook::IsAskedInVain() {
  const Known known = Look();
  return known != nullptr && known->empty();
}

Result<Caller> TokenBook::Authenticate(std::optional<std::string_view> authorization) {
  const Known known = Look();
  if (known == nullptr) return Caller();
  if (!authorization) {
    return Unauthenticated("TOKEN_MISSING",
                           "the server asks for a token; send one in the metadata as "
                           "'authorization: Bearer TOKEN' (maploc: --token-file)");
  }
  const std::optional<Token> token = authorization->starts_with(kScheme)
                                         ? ParseToken(authorization->substr(kScheme.size()))
                                         : std::nullopt;
  if (!token) {
    return Unauthenticated("TOKEN_MALFORMED",
                           "what was sent is no token; maploc-server token create makes one");
  }
  const auto found = known->find(token->id);
  if (found == known->end() || !SameHash(found->second.hash, HashSecret(token->secret))) {
    return Unauthenticated("TOKEN_WRONG",
                           "the server does not know this token; was it made for another store?");
  }
  // Only after the secret was found right: nobody else learns what became of a token.
  if (found->second.revoked_unix_ns) {
    return Unauthenticated("TOKEN_REVOKED", "token " + token->id +
                                                " has been revoked; maploc-server token create "
                                                "makes another one");
  }
  const std::optional<std::int64_t> expires = found->second.expires_unix_ns;
  if (expires && SystemClock().NowUnixNanos() >= *expires) {
    return Unauthenticated("TOKEN_EXPIRED", "token " + token->id +
                                                " has expired; maploc-server token create makes "
                                                "another one");
  }
  return Caller(found->second.grant);
}

}  // namespace maploc
