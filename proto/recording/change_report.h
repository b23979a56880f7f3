// The report about queries that were answered twice: a table for people, JSON for programs.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "mapstore/model/localization.h"
#include "proto/recording/answer_change.h"
#include "proto/recording/recorded_query.h"

namespace maploc {

class ChangeReport {
 public:
  // What the answers are of: "version 1", "version 2".
  ChangeReport(std::string before, std::string after);

  // Returns what has become of it.
  Change Add(const RecordedQuery& recorded, const Result<Localization>& before,
             const Result<Localization>& after);

  nlohmann::ordered_json Json() const;
  // The queries that changed, then the sums.
  void Print(std::ostream& out) const;

 private:
  // Of one answer, what is told.
  struct Told {
    std::string outcome;
    std::optional<double> sigma;  // of the position, map unit
    int inliers = 0;
  };
  struct Row {
    std::int64_t answered_unix_ns = 0;
    std::string robot;
    std::string request_id;
    Told before;
    Told after;
    AnswerChange change;

    // Of the position's sigmas, after to before.
    std::optional<double> SigmaRatio() const;
  };
  struct Sums {
    int better = 0, worse = 0, moved = 0, same = 0;
    int localized_before = 0, localized_after = 0;
    std::optional<double> sigma_ratio;  // after to before, the median; none localized both times
  };

  static Told Tell(const Result<Localization>& answer);
  static nlohmann::ordered_json RowJson(const Row& row);
  Sums Sum() const;
  // "better", "worse": by more than chance; "no difference".
  static std::string Verdict(const Sums& sums);
  std::string Conclusion(const Sums& sums) const;

  const std::string before_;
  const std::string after_;
  std::vector<Row> rows_;
};

}  // namespace maploc
