// What other robots saw in a segment at about the time that one session did.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace maploc {

// What a session of a robot saw in a segment. Robots are numbers that the caller gives.
struct TimedValue {
  std::int64_t start_unix_ns = 0;
  double value = 0.0;
  std::size_t robot = 0;
};

// Sorts once, and then finds each session's references in O(log sessions + references), however
// many sessions of its own robot lie between, or start in the same moment. Immutable: const access
// from several threads is safe.
class SegmentReferences {
 public:
  explicit SegmentReferences(std::span<const TimedValue> values);

  // The values of other robots than `robot`, the nearest in time to `start_unix_ns` first, of
  // equally near ones the smallest first; at most `most`.
  std::vector<double> Nearest(std::int64_t start_unix_ns, std::size_t robot,
                              std::int64_t most) const;
  // The same of the sessions that started earlier, and of those at `start_unix_ns` or later.
  std::vector<double> Earlier(std::int64_t start_unix_ns, std::size_t robot,
                              std::int64_t most) const;
  std::vector<double> Later(std::int64_t start_unix_ns, std::size_t robot, std::int64_t most) const;

 private:
  // Values in the order in which they are met on the way from now into the future; for the past,
  // with the times mirrored.
  class Lane {
   public:
    Lane(std::span<const TimedValue> values, bool mirrored);
    // The first one at `time` (`inclusive`), or after it, of another robot than `robot`.
    std::size_t First(std::int64_t time, bool inclusive, std::size_t robot) const;
    std::size_t After(std::size_t index, std::size_t robot) const;
    std::vector<double> Walk(std::size_t first, std::size_t robot, std::int64_t most) const;
    bool Has(std::size_t index) const { return index < values_.size(); }
    const TimedValue& At(std::size_t index) const { return values_[index]; }

   private:
    std::size_t SkipOwn(std::size_t index, std::size_t robot) const;

    std::vector<TimedValue> values_;       // by time, then value; the times mirrored or not
    std::vector<std::size_t> next_other_;  // the next one of another robot than this one's
  };

  Lane later_;    // and those of the same moment
  Lane earlier_;  // mirrored
};

}  // namespace maploc
