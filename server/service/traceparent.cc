#include "server/service/traceparent.h"

#include "server/access/token.h"

namespace maploc {
namespace {

constexpr std::size_t kLength = 55;  // 00-<32 digits>-<16 digits>-00

bool IsZero(std::string_view digits) { return digits.find_first_not_of('0') == digits.npos; }

}  // namespace

std::string ParseTraceparent(std::string_view header) {
  if (header.size() < kLength) return "";
  const std::string_view version = header.substr(0, 2);
  const std::string_view trace = header.substr(3, 32);
  const std::string_view parent = header.substr(36, 16);
  const std::string_view flags = header.substr(53, 2);
  const bool dashes = header[2] == '-' && header[35] == '-' && header[52] == '-';
  const bool digits = IsHex(version, 2) && IsHex(trace, 32) && IsHex(parent, 16) && IsHex(flags, 2);
  // Later versions may append fields after a dash. Version ff and identifiers of zeros are invalid
  // (W3C Trace Context 3.2.2).
  const bool ends = header.size() == kLength || (version != "00" && header[kLength] == '-');
  if (!dashes || !digits || !ends || version == "ff") return "";
  if (IsZero(trace) || IsZero(parent)) return "";
  return std::string(header.substr(0, kLength));
}

}  // namespace maploc
