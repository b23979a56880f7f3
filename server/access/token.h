// A bearer token: "maploc-", 16 hexadecimal digits that name it, "-", 64 that are secret. Both
// come from the kernel's generator. Thread-safe.
//
// Kept is the SHA-256 of the secret. A slow hash would protect what people choose, by making each
// guess dear; nobody guesses 256 random bits, at whatever price, and each call pays for the hash.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

struct Token {
  std::string id;      // 16 digits; no secret
  std::string secret;  // 64 digits
};

Result<Token> NewToken();
// As its bearer has it.
std::string TokenText(const Token& token);
// Nullopt: no token.
std::optional<Token> ParseToken(std::string_view text);

// SHA-256 as 64 hexadecimal digits.
std::string HashSecret(std::string_view secret);
// Takes as long wherever they differ.
bool SameHash(const std::string& a, const std::string& b);

// Lower-case hexadecimal digits, `digits` of them.
bool IsHex(std::string_view text, std::size_t digits);

}  // namespace maploc
