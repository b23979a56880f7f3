#include "server/access/caller.h"

#include <algorithm>
#include <array>

namespace maploc {
namespace {

// In the order of Role.
constexpr std::array<std::string_view, 3> kRoleNames{"robot", "operator", "viewer"};

Status Forbidden(const char* reason, const std::string& why) {
  return Status(StatusCode::kPermissionDenied, reason, why);
}

}  // namespace

std::string_view RoleName(Role role) { return kRoleNames[static_cast<std::size_t>(role)]; }

std::optional<Role> RoleFromName(std::string_view name) {
  const auto* const found = std::ranges::find(kRoleNames, name);
  if (found == kRoleNames.end()) return std::nullopt;
  return static_cast<Role>(found - kRoleNames.begin());
}

bool Caller::MayRead(const std::string& map) const {
  return !grant_ || grant_->maps.empty() ||
         std::ranges::find(grant_->maps, map) != grant_->maps.end();
}

Status Caller::CheckRead(const std::string& map) const {
  if (MayRead(map)) return Status::Ok();
  return Forbidden("MAP_FORBIDDEN", "map: the token is not for map '" + map + "'");
}

Status Caller::CheckRobot() const {
  if (!grant_ || grant_->role == Role::kRobot) return Status::Ok();
  return Forbidden("ROLE_FORBIDDEN", "the token's role is " + std::string(RoleName(grant_->role)) +
                                         "; a robot's token is needed");
}

Status Caller::CheckStart(const std::string& map, const std::string& robot) const {
  MAPLOC_RETURN_IF_ERROR(CheckRobot());
  MAPLOC_RETURN_IF_ERROR(CheckRead(map));
  if (!grant_ || grant_->robot == robot) return Status::Ok();
  return Forbidden("ROBOT_FORBIDDEN",
                   "robot: the token is that of robot '" + grant_->robot +
                       "', the session would be that of '" + robot +
                       "'; start it under the token's name (--robot), or use another token");
}

Status Caller::CheckLocalize(const std::string& map) const {
  MAPLOC_RETURN_IF_ERROR(CheckRobot());
  return CheckRead(map);
}

// Whose it is is not told.
Status Caller::CheckOwn(const Session& session) const {
  if (!grant_ || grant_->robot == session.robot) return Status::Ok();
  return Forbidden("SESSION_FORBIDDEN", "session_id: the session is another robot's");
}

Status Caller::CheckLocalizeIn(const Session& session) const {
  MAPLOC_RETURN_IF_ERROR(CheckRobot());
  MAPLOC_RETURN_IF_ERROR(CheckOwn(session));
  return CheckRead(session.map.name);
}

Status Caller::CheckEnd(const Session& session) const {
  if (grant_ && grant_->role == Role::kOperator) return CheckRead(session.map.name);
  // Without CheckRead: a robot may end what it has begun, also with a new token that is not for the
  // map.
  MAPLOC_RETURN_IF_ERROR(CheckRobot());
  return CheckOwn(session);
}

}  // namespace maploc
