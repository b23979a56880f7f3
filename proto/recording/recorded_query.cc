#include "proto/recording/recorded_query.h"

#include <algorithm>
#include <cmath>

#include "maploc/recording/v1/recording.pb.h"
#include "mapstore/base/name.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

// Refusals are printed, so that their text must not hold what steers a terminal.
std::string Printable(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

Status ReadRefusal(const recording::v1::Refusal& refusal, RecordedQuery& recorded) {
  const auto code = static_cast<StatusCode>(refusal.code());
  if (!IsAboutTheQuery(code)) {
    return InvalidArgument("refusal.code", "is none that is recorded", "OUT_OF_RANGE");
  }
  MAPLOC_RETURN_IF_ERROR(CheckName("refusal.reason", refusal.reason()));
  recorded.answer = Status(code, refusal.reason(), Printable(refusal.message()));
  return Status::Ok();
}

// How the query ended, into `recorded`.
Status ReadResult(const recording::v1::RecordedQuery& proto, RecordedQuery& recorded) {
  if (proto.has_answer()) {
    recorded.answer = LocalizationFromProto(proto.answer(), recorded.map.name);
    return recorded.answer.status().WithContext("answer");
  }
  if (proto.has_refusal()) return ReadRefusal(proto.refusal(), recorded);
  return InvalidArgument("answer", "must be set, or refusal", "REQUIRED");
}

Status CheckNumbers(const recording::v1::RecordedQuery& proto) {
  if (proto.map_version() < 0) {
    return InvalidArgument("map_version", "must be at least 0", "OUT_OF_RANGE");
  }
  if (!std::isfinite(proto.total_ms()) || proto.total_ms() < 0.0) {
    return InvalidArgument("total_ms", "must be finite and at least 0", "OUT_OF_RANGE");
  }
  if (proto.stands_for_count() < 1) {
    return InvalidArgument("stands_for_count", "must be at least 1", "OUT_OF_RANGE");
  }
  return Status::Ok();
}

}  // namespace

Query RecordedQuery::ToRepeat() const {
  Query repeat = query;
  repeat.session.clear();
  repeat.request_id.clear();
  repeat.map = map.name;
  repeat.map_version = 0;
  return repeat;
}

bool IsAboutTheQuery(StatusCode code) {
  return code == StatusCode::kDeadlineExceeded || code == StatusCode::kFailedPrecondition ||
         code == StatusCode::kInternal || code == StatusCode::kDataLoss;
}

std::string_view OutcomeText(const Result<Localization>& answer) {
  return answer.ok() ? OutcomeName(answer->outcome) : StatusCodeName(answer.status().code());
}

Result<RecordedQuery> RecordedQueryFromBytes(std::string_view record) {
  recording::v1::RecordedQuery proto;
  if (!proto.ParseFromArray(record.data(), static_cast<int>(record.size()))) {
    return InvalidArgument("record", "is no maploc.recording.v1.RecordedQuery", "NOT_PARSED");
  }
  RecordedQuery recorded;
  MAPLOC_RETURN_IF_ERROR(CheckNumbers(proto));
  MAPLOC_RETURN_IF_ERROR(CheckName("robot", proto.robot()));
  MAPLOC_RETURN_IF_ERROR(CheckName("map", proto.map()));
  recorded.robot = proto.robot();
  recorded.map = {proto.map(), proto.map_version()};
  Result<Query> query = QueryFromProto(proto.request());
  if (!query.ok()) return query.status().WithContext("request");
  recorded.query = *std::move(query);
  MAPLOC_RETURN_IF_ERROR(ReadResult(proto, recorded));
  recorded.answered_unix_ns = proto.answered_unix_nanos();
  recorded.total_ms = proto.total_ms();
  recorded.stands_for = proto.stands_for_count();
  return recorded;
}

}  // namespace maploc
