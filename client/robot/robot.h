// A robot that can be asked for its queries one by one and knows, apart from them, where it truly
// was. A recorded robot (recorded_robot.h) and a made-up one (simulated_robot.h) are such robots.
#pragma once

#include <optional>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/model/query.h"

namespace maploc {

// Const methods are thread-safe.
class Robot {
 public:
  virtual ~Robot() = default;

  virtual int QueryCount() const = 0;
  // Unique within the robot. REQUIRES: 0 <= index < QueryCount().
  virtual std::string QueryName(int index) const = 0;
  // View and gravity; nothing of the session and nothing of the reference.
  virtual Result<Query> MakeQuery(int index) const = 0;
  // Where it was: never sent.
  virtual Rigid3 ReferenceMapFromBody(int index) const = 0;
  // Median depth of what it saw, in the map's unit, where that is known: the scale of its errors.
  virtual std::optional<double> SceneDepth(int index) const = 0;
};

}  // namespace maploc
