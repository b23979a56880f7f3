#include "server/access/token.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <span>

#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <sys/random.h>

namespace maploc {
namespace {

constexpr std::string_view kPrefix = "maploc-";
constexpr std::size_t kIdBytes = 8;
constexpr std::size_t kSecretBytes = 32;
constexpr std::size_t kIdDigits = 2 * kIdBytes;
constexpr std::size_t kSecretDigits = 2 * kSecretBytes;

std::string Hex(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text.push_back(kDigits[byte >> 4]);
    text.push_back(kDigits[byte & 15]);
  }
  return text;
}

}  // namespace

Result<Token> NewToken() {
  std::array<std::uint8_t, kIdBytes + kSecretBytes> bytes;
  // Waits until the kernel's generator is seeded, which may take a moment after the machine's
  // start; a signal ends the wait.
  ssize_t got = -1;
  do {
    got = getrandom(bytes.data(), bytes.size(), 0);
  } while (got < 0 && errno == EINTR);
  if (got != static_cast<ssize_t>(bytes.size())) return Internal("the kernel gives no randomness");
  const std::span all(bytes);
  return Token{Hex(all.first(kIdBytes)), Hex(all.subspan(kIdBytes))};
}

std::string TokenText(const Token& token) {
  return std::string(kPrefix) + token.id + "-" + token.secret;
}

std::optional<Token> ParseToken(std::string_view text) {
  if (text.size() != kPrefix.size() + kIdDigits + 1 + kSecretDigits) return std::nullopt;
  const std::string_view id = text.substr(kPrefix.size(), kIdDigits);
  const std::string_view secret = text.substr(text.size() - kSecretDigits);
  const bool good = text.starts_with(kPrefix) && text[kPrefix.size() + kIdDigits] == '-' &&
                    IsHex(id, kIdDigits) && IsHex(secret, kSecretDigits);
  return good ? std::optional(Token{std::string(id), std::string(secret)}) : std::nullopt;
}

std::string HashSecret(std::string_view secret) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const std::uint8_t*>(secret.data()), secret.size(), digest.data());
  return Hex(digest);
}

bool SameHash(const std::string& a, const std::string& b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

bool IsHex(std::string_view text, std::size_t digits) {
  return text.size() == digits && std::ranges::all_of(text, [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

}  // namespace maploc
