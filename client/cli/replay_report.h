// A replayed session as a JSON document (interface.md) and as a table.
#pragma once

#include <iosfwd>

#include <nlohmann/json.hpp>

#include "client/api/client.h"
#include "client/robot/replay.h"

namespace maploc {

// Whether the report can tell wrong answers from right ones: lengths have a unit, or the scene's
// depth is known. Else JSON's "wrong" and "recall" count map units as metres.
bool JudgesWrong(const RemoteMap& map, const ReplayReport& report);
nlohmann::ordered_json ReplayJson(const RemoteMap& map, const ReplayReport& report);
void PrintReplay(const RemoteMap& map, const ReplayReport& report, std::ostream& out);
nlohmann::ordered_json SummaryJson(const SessionSummary& summary);
void PrintSummary(const SessionSummary& summary, std::ostream& out);

}  // namespace maploc
