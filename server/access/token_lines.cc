#include "server/access/token_lines.h"

#include <nlohmann/json.hpp>

#include "mapstore/base/name.h"

namespace maploc {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kIdDigits = 16;
constexpr std::size_t kHashDigits = 64;

// The field, or a null of its own.
const Json& At(const Json& object, const char* field) {
  static const Json none;
  const auto found = object.is_object() ? object.find(field) : object.end();
  return found == object.end() ? none : *found;
}

std::string Text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : std::string();
}

Result<TokenRecord> ParseRecord(const Json& json) {
  TokenRecord record;
  const std::optional<Role> role = RoleFromName(Text(At(json, "role")));
  if (!role) return InvalidArgument("role", "is none of robot, operator, viewer");
  record.grant.role = *role;
  record.grant.robot = Text(At(json, "robot"));
  const Json& maps = At(json, "maps");
  // Without a list the token would be for all maps.
  if (!maps.is_array()) return InvalidArgument("maps", "is no list");
  for (const Json& map : maps) record.grant.maps.push_back(Text(map));
  MAPLOC_RETURN_IF_ERROR(CheckGrant(record.grant));
  record.hash = Text(At(json, "sha256"));
  if (!IsHex(record.hash, kHashDigits)) return InvalidArgument("sha256", "is no SHA-256");
  if (!At(json, "unix_ns").is_number_integer()) return InvalidArgument("unix_ns", "is no time");
  record.created_unix_ns = At(json, "unix_ns").get<std::int64_t>();
  const Json& expires = At(json, "expires_unix_ns");
  // A token whose end cannot be read must not live for ever.
  if (!expires.is_null() && !expires.is_number_integer()) {
    return InvalidArgument("expires_unix_ns", "is no time");
  }
  if (!expires.is_null()) record.expires_unix_ns = expires.get<std::int64_t>();
  return record;
}

Status AddLine(std::string_view line, TokenRecords* records) {
  const Json json = Json::parse(line, nullptr, /*allow_exceptions=*/false);
  // A line that is no JSON has no id, and is refused as such.
  const std::string id = Text(At(json, "id"));
  if (!IsHex(id, kIdDigits)) return InvalidArgument("id", "is not 16 hexadecimal digits");
  const std::string event = Text(At(json, "event"));
  if (event == "created") {
    MAPLOC_ASSIGN_OR_RETURN(TokenRecord record, ParseRecord(json));
    if (records->emplace(id, std::move(record)).second) return Status::Ok();
    return InvalidArgument("id", "stands twice");
  }
  if (event != "revoked") return InvalidArgument("event", "is neither created nor revoked");
  const auto found = records->find(id);
  if (found == records->end()) return InvalidArgument("id", "was never created");
  if (!At(json, "unix_ns").is_number_integer()) return InvalidArgument("unix_ns", "is no time");
  found->second.revoked_unix_ns = At(json, "unix_ns").get<std::int64_t>();
  return Status::Ok();
}

}  // namespace

Status CheckGrant(const Grant& grant) {
  MAPLOC_RETURN_IF_ERROR(CheckName("robot", grant.robot));
  if ((grant.role == Role::kRobot) == grant.robot.empty()) {
    return InvalidArgument("robot", "a robot's token names its robot, and no other token does");
  }
  if (grant.maps.size() > kMaxMapsOfToken) {
    return InvalidArgument("maps", "are more than " + std::to_string(kMaxMapsOfToken) +
                                       "; leave them out for all maps");
  }
  for (const std::string& map : grant.maps) {
    if (map.empty()) return InvalidArgument("maps", "hold an empty name");
    MAPLOC_RETURN_IF_ERROR(CheckName("maps", map));
  }
  return Status::Ok();
}

std::string CreatedLine(const std::string& id, const TokenRecord& record) {
  Json line{{"event", "created"},
            {"id", id},
            {"role", RoleName(record.grant.role)},
            {"robot", record.grant.robot},
            {"maps", record.grant.maps},
            {"sha256", record.hash},
            {"unix_ns", record.created_unix_ns}};
  if (record.expires_unix_ns) line["expires_unix_ns"] = *record.expires_unix_ns;
  // It does not throw, because CheckGrant refuses names that are not UTF-8.
  return line.dump() + "\n";
}

std::string RevokedLine(const std::string& id, std::int64_t unix_ns) {
  return Json{{"event", "revoked"}, {"id", id}, {"unix_ns", unix_ns}}.dump() + "\n";
}

Result<TokenRecords> ParseTokenLines(const std::string& path, std::string_view text) {
  TokenRecords records;
  for (int number = 1;; ++number) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return records;
    const Status added = AddLine(text.substr(0, end), &records);
    if (!added.ok()) return InvalidFile(path + ":" + std::to_string(number), added.message());
    text.remove_prefix(end + 1);
  }
}

}  // namespace maploc
