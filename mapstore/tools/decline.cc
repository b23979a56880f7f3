#include "mapstore/tools/decline.h"

#include <algorithm>
#include <iostream>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"

namespace maploc {

std::vector<Decline> RankDeclines(const std::vector<SegmentChanges>& segments) {
  std::vector<Decline> declines;
  for (const SegmentChanges& segment : segments) {
    for (const ChangePoint& change : segment.changes) {
      if (change.after < change.before) declines.push_back({segment.segment, change});
    }
  }
  // Stable, so that of equal losses the lower segment comes first in every run.
  std::stable_sort(declines.begin(), declines.end(),
                   [](const Decline& a, const Decline& b) { return a.Loss() > b.Loss(); });
  return declines;
}

nlohmann::ordered_json ToJson(const std::vector<ChangePoint>& changes) {
  auto json = nlohmann::ordered_json::array();
  for (const ChangePoint& change : changes) {
    json.push_back({{"kind", ChangeKindName(change.kind)},
                    {"since_session", change.since},
                    {"since_unix_ns", change.since_unix_ns},
                    {"since", UtcText(change.since_unix_ns)},
                    {"sessions", change.sessions},
                    {"before", change.before},
                    {"after", change.after},
                    {"deviation", change.deviation}});
  }
  return json;
}

void PrintDeclines(const std::vector<Decline>& declines) {
  if (declines.empty()) {
    std::cout << "\nNo segment has become worse.\n";
    return;
  }
  std::cout << "\nSegments that got worse, worst first:\n";
  Table table({"segment", "what fell", "from", "to", "since", "session", "sessions since"});
  for (const Decline& decline : declines) {
    const ChangePoint& change = decline.change;
    table.AddRow({std::to_string(decline.segment), std::string(ChangeKindName(change.kind)),
                  FixedText(change.before, 3), FixedText(change.after, 3),
                  UtcText(change.since_unix_ns), change.since, std::to_string(change.sessions)});
  }
  table.Print(std::cout);
}

}  // namespace maploc
