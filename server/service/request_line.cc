#include "server/service/request_line.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace maploc {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxFreeText = 400;  // bytes

class Line {
 public:
  Line(bool json, const char* message) : json_(json) {
    if (json) Add("message", message);
    if (!json) text_ = message;
  }

  void Add(const char* key, const Json& value) { AddValue(key, value, /*ascii=*/false); }
  void AddUnlessEmpty(const char* key, const std::string& value) {
    if (!value.empty()) Add(key, value);
  }
  // Other than a name it may hold anything of any length: what is not ASCII is escaped.
  void AddFreeText(const char* key, const std::string& value) {
    AddValue(key, value.substr(0, kMaxFreeText), /*ascii=*/true);
  }
  // To the microsecond.
  void AddMs(const char* key, double milliseconds) {
    Add(key, std::round(milliseconds * 1000.0) / 1000.0);
  }
  std::string Take() { return std::move(text_); }

 private:
  void AddValue(const char* key, const Json& value, bool ascii) {
    const std::string text = value.dump(-1, ' ', ascii, Json::error_handler_t::replace);
    if (json_) {
      text_ += (text_.empty() ? "\"" : ",\"") + std::string(key) + "\":" + text;
    } else {
      text_ += " " + std::string(key) + "=" + text;
    }
  }

  const bool json_;
  std::string text_;
};

void AddStages(const StageTimes& times, Line& line) {
  line.AddMs("convert_ms", times.convert_ms);
  line.AddMs("retrieval_ms", times.retrieval_ms);
  line.AddMs("matching_ms", times.matching_ms);
  line.AddMs("ransac_ms", times.ransac_ms);
  line.AddMs("refinement_ms", times.refinement_ms);
}

void AddFacts(const RequestFacts& facts, Line& line) {
  line.AddUnlessEmpty("request_id", facts.request_id);
  line.AddUnlessEmpty("robot", facts.robot);
  line.AddUnlessEmpty("map", facts.map);
  if (facts.version > 0) line.Add("version", facts.version);
  line.AddUnlessEmpty("session", facts.session);
}

}  // namespace

std::string RequestLine(const FinishedRequest& request, bool json, bool stages) {
  Line line(json, "request");
  line.Add("method", request.method);
  line.Add("code", StatusCodeName(request.status.code()));
  if (request.facts.outcome) line.Add("outcome", OutcomeName(*request.facts.outcome));
  line.AddMs("ms", request.total_ms);
  line.AddMs("wait_ms", request.wait_ms);
  if (stages && request.facts.outcome) AddStages(request.facts.times, line);
  line.AddUnlessEmpty("traceparent", request.traceparent);
  AddFacts(request.facts, line);
  if (!request.status.ok()) {
    line.Add("reason", request.status.reason());
    line.AddFreeText("error", request.status.message());
  }
  return line.Take();
}

std::string CountLine(std::string_view method, std::string_view reason, std::int64_t count,
                      bool json) {
  Line line(json, "requests refused again");
  line.Add("method", method);
  line.Add("reason", reason);
  line.Add("count", count);
  return line.Take();
}

}  // namespace maploc
