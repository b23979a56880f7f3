// Who makes a call, and what that allows. Without gRPC.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/model/session.h"

namespace maploc {

enum class Role { kRobot, kOperator, kViewer };

// "robot", "operator", "viewer".
std::string_view RoleName(Role role);
std::optional<Role> RoleFromName(std::string_view name);

// What a token gives its bearer.
struct Grant {
  Role role = Role::kViewer;
  std::string robot;              // of a robot alone: under which name it works
  std::vector<std::string> maps;  // which maps; empty: all
};

// A plain value. Where nobody is asked for a token everything is allowed. Every refusal is
// PERMISSION_DENIED: ROLE_FORBIDDEN, MAP_FORBIDDEN, ROBOT_FORBIDDEN, SESSION_FORBIDDEN. A map is
// refused before anybody looks whether it exists.
class Caller {
 public:
  // Everything is allowed.
  Caller() = default;
  explicit Caller(Grant grant) : grant_(std::move(grant)) {}

  bool is_restricted() const { return grant_.has_value(); }
  // The robot that the token names; empty where nobody is asked, and for operators and viewers.
  std::string robot() const { return grant_ ? grant_->robot : std::string(); }
  bool MayRead(const std::string& map) const;
  // Every role may.
  Status CheckRead(const std::string& map) const;
  // Robots alone, under their own name.
  Status CheckStart(const std::string& map, const std::string& robot) const;
  // Robots alone; outside of a session.
  Status CheckLocalize(const std::string& map) const;
  // Robots alone, in their own sessions.
  Status CheckLocalizeIn(const Session& session) const;
  // A robot its own sessions; an operator all of his maps.
  Status CheckEnd(const Session& session) const;

 private:
  Status CheckRobot() const;
  Status CheckOwn(const Session& session) const;

  std::optional<Grant> grant_;  // none: not asked
};

}  // namespace maploc
