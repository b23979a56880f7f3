#include "server/service/log_format.h"

#include <string>

#include <nlohmann/json.hpp>
#include <spdlog/pattern_formatter.h>

namespace maploc {
namespace {

// The flag that stands for the message as a member of a JSON object.
constexpr char kMessageFlag = '*';

// spdlog's own %v writes a message as it is; inside a JSON string its quotes and control characters
// must be escaped.
class MessageMember final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    const nlohmann::json value(std::string(message.payload.begin(), message.payload.end()));
    // All but ASCII is escaped: a message may quote anything, also marks that turn the direction of
    // writing.
    const std::string text =
        "\"message\":" + value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<MessageMember>();
  }
};

std::unique_ptr<spdlog::pattern_formatter> Object(const std::string& members) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  formatter->add_flag<MessageMember>(kMessageFlag);
  formatter->set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",)" + members + "}");
  return formatter;
}

}  // namespace

std::unique_ptr<spdlog::formatter> JsonMessages() {
  return Object(std::string("%") + kMessageFlag);
}

std::unique_ptr<spdlog::formatter> JsonMembers() { return Object("%v"); }

}  // namespace maploc
