// Reading text by hand: fields apart by blanks, numbers checked to their last character, so that an
// error can say which field of which line is wrong. Only for this folder.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

// The text between quotes, cut to what an error message can hold.
inline std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  quoted.append(text.substr(0, 40));
  return quoted.append("'");
}

// The fields of one line, read from the left.
class TextFields {
 public:
  explicit TextFields(std::string_view line) : rest_(line) {}

  // Empty at the end.
  std::string_view Word() {
    const std::size_t start = rest_.find_first_not_of(kBlanks);
    if (start == std::string_view::npos) return rest_ = {};
    const std::size_t end = std::min(rest_.find_first_of(kBlanks, start), rest_.size());
    const std::string_view word = rest_.substr(start, end - start);
    rest_.remove_prefix(end);
    return word;
  }
  // All that is left, without blanks at its ends.
  std::string_view Rest() {
    const std::size_t start = rest_.find_first_not_of(kBlanks);
    if (start == std::string_view::npos) return rest_ = {};
    const std::string_view rest = rest_.substr(start, rest_.find_last_not_of(kBlanks) + 1 - start);
    rest_ = {};
    return rest;
  }
  bool AtEnd() const { return rest_.find_first_not_of(kBlanks) == std::string_view::npos; }

  // T is an integer or double; a double must be finite. The error starts with `what`.
  template <typename T>
  Result<T> Number(std::string_view what) {
    MAPLOC_ASSIGN_OR_RETURN(const T value, AnyNumber<T>(what));
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) return InvalidArgument(what, "is not finite");
    }
    return value;
  }
  // As Number, but NaN and infinity are numbers, too.
  template <typename T>
  Result<T> AnyNumber(std::string_view what) {
    const std::string_view word = Word();
    if (word.empty()) return InvalidArgument(what, "is missing");
    T value{};
    // from_chars does not know the sign that everybody else takes.
    const std::string_view digits = word.substr(word[0] == '+' && word.size() > 1 ? 1 : 0);
    const char* last = digits.data() + digits.size();
    const auto [end, error] = std::from_chars(digits.data(), last, value);
    if (error != std::errc() || end != last || (digits != word && digits[0] == '-')) {
      return InvalidArgument(what, Quoted(word) + " is not a number");
    }
    return value;
  }

 private:
  static constexpr std::string_view kBlanks = " \t\r";
  std::string_view rest_;
};

// The lines of a text in memory, counted from 1.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : rest_(text) {}

  // The next line without its end; false at the end of the text.
  bool Next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }
  // As Next, but skips blank lines and comments ('#' at the line's start).
  bool NextRecord(std::string_view& line) {
    while (Next(line)) {
      const std::size_t start = line.find_first_not_of(" \t\r");
      if (start != std::string_view::npos && line[start] != '#') return true;
    }
    return false;
  }
  // Of the line that was read last.
  std::int64_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::int64_t number_ = 0;
};

}  // namespace maploc
