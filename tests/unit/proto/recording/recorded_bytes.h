// Recordings as a server writes them, made by hand.
#pragma once

#include <string>
#include <vector>

#include "maploc/recording/v1/recording.pb.h"
#include "mapstore/model/localization.h"
#include "proto/convert/convert.h"
#include "proto/recording/crc_frame.h"
#include "tests/unit/proto/convert/valid_request.h"

namespace maploc::testing {

inline Localization LocalizedAnswer() {
  Localization answer;
  answer.outcome = Outcome::kLocalized;
  answer.map = {"yard", 3};
  answer.segment = 2;
  answer.map_from_body = Rigid3{Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 2, 3)};
  answer.covariance = 0.01 * PoseCovariance::Identity();
  answer.evidence.confidence = 1.0;
  answer.evidence.points = {40, 30};
  return answer;
}

// A query of "rover-1" on the map "yard" that became `answer`.
inline recording::v1::RecordedQuery ValidRecord(const Localization& answer = LocalizedAnswer()) {
  recording::v1::RecordedQuery record;
  *record.mutable_request() = ValidRequest();
  LocalizationToProto(QueryFromProto(record.request()).value(), answer, false,
                      record.mutable_answer());
  record.set_robot("rover-1");
  record.set_map("yard");
  record.set_map_version(3);
  record.set_answered_unix_nanos(1'700'000'000'000'000'000);
  record.set_total_ms(12.5);
  record.set_stands_for_count(1);
  return record;
}

inline recording::v1::RecordedQuery RefusedRecord(StatusCode code, const std::string& reason) {
  recording::v1::RecordedQuery record = ValidRecord();
  record.mutable_refusal()->set_code(static_cast<int>(code));
  record.mutable_refusal()->set_reason(reason);
  record.mutable_refusal()->set_message("it cannot be");
  return record;
}

inline std::string Framed(const std::string& record) {
  const auto frame = FrameToBytes(FrameOf(record));
  return std::string(frame.begin(), frame.end()) + record;
}

inline std::string RecordingBytes(const std::vector<recording::v1::RecordedQuery>& records) {
  std::string bytes(kRecordingMagic);
  for (const auto& record : records) bytes += Framed(record.SerializeAsString());
  return bytes;
}

}  // namespace maploc::testing
