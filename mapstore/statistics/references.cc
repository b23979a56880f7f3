#include "mapstore/statistics/references.h"

#include <algorithm>
#include <utility>

namespace maploc {
namespace {

// Turns the order around and keeps distances, as -time does, which however overflows for the least.
std::int64_t Mirror(std::int64_t time) { return ~time; }

using Met = std::pair<std::uint64_t, double>;  // distance in time, value

// REQUIRES: value.start_unix_ns >= time. Unsigned, so that no distance overflows.
Met MetFrom(std::int64_t time, const TimedValue& value) {
  return {static_cast<std::uint64_t>(value.start_unix_ns) - static_cast<std::uint64_t>(time),
          value.value};
}

}  // namespace

SegmentReferences::Lane::Lane(std::span<const TimedValue> values, bool mirrored)
    : values_(values.begin(), values.end()), next_other_(values.size()) {
  for (TimedValue& value : values_) {
    if (mirrored) value.start_unix_ns = Mirror(value.start_unix_ns);
  }
  std::sort(values_.begin(), values_.end(), [](const TimedValue& a, const TimedValue& b) {
    return std::pair(a.start_unix_ns, a.value) < std::pair(b.start_unix_ns, b.value);
  });
  for (std::size_t i = values_.size(); i-- > 0;) {
    const bool run = i + 1 < values_.size() && values_[i + 1].robot == values_[i].robot;
    next_other_[i] = run ? next_other_[i + 1] : i + 1;
  }
}

std::size_t SegmentReferences::Lane::SkipOwn(std::size_t index, std::size_t robot) const {
  return Has(index) && values_[index].robot == robot ? next_other_[index] : index;
}

std::size_t SegmentReferences::Lane::First(std::int64_t time, bool inclusive,
                                           std::size_t robot) const {
  const auto first =
      std::partition_point(values_.begin(), values_.end(), [&](const TimedValue& value) {
        return inclusive ? value.start_unix_ns < time : value.start_unix_ns <= time;
      });
  return SkipOwn(static_cast<std::size_t>(first - values_.begin()), robot);
}

std::size_t SegmentReferences::Lane::After(std::size_t index, std::size_t robot) const {
  return SkipOwn(index + 1, robot);
}

std::vector<double> SegmentReferences::Lane::Walk(std::size_t first, std::size_t robot,
                                                  std::int64_t most) const {
  std::vector<double> values;
  for (std::size_t i = first; Has(i) && static_cast<std::int64_t>(values.size()) < most;
       i = After(i, robot)) {
    values.push_back(values_[i].value);
  }
  return values;
}

SegmentReferences::SegmentReferences(std::span<const TimedValue> values)
    : later_(values, false), earlier_(values, true) {}

std::vector<double> SegmentReferences::Nearest(std::int64_t start_unix_ns, std::size_t robot,
                                               std::int64_t most) const {
  const std::int64_t mirrored = Mirror(start_unix_ns);
  std::size_t later = later_.First(start_unix_ns, true, robot);
  std::size_t earlier = earlier_.First(mirrored, false, robot);
  std::vector<double> values;
  while (static_cast<std::int64_t>(values.size()) < most) {
    const bool has_later = later_.Has(later);
    const bool has_earlier = earlier_.Has(earlier);
    if (!has_later && !has_earlier) break;
    if (!has_earlier || (has_later && MetFrom(start_unix_ns, later_.At(later)) <
                                          MetFrom(mirrored, earlier_.At(earlier)))) {
      values.push_back(later_.At(later).value);
      later = later_.After(later, robot);
    } else {
      values.push_back(earlier_.At(earlier).value);
      earlier = earlier_.After(earlier, robot);
    }
  }
  return values;
}

std::vector<double> SegmentReferences::Earlier(std::int64_t start_unix_ns, std::size_t robot,
                                               std::int64_t most) const {
  return earlier_.Walk(earlier_.First(Mirror(start_unix_ns), false, robot), robot, most);
}

std::vector<double> SegmentReferences::Later(std::int64_t start_unix_ns, std::size_t robot,
                                             std::int64_t most) const {
  return later_.Walk(later_.First(start_unix_ns, true, robot), robot, most);
}

}  // namespace maploc
