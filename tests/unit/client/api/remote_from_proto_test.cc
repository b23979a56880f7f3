// What a client must not believe of a server's answers about maps.
#include "client/api/remote_from_proto.h"

#include <limits>

#include <gtest/gtest.h>

#include "maploc/v1/map_service.pb.h"

namespace maploc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

v1::Segment GoodSegment() {
  v1::Segment segment;
  segment.set_strategy(v1::STRATEGY_2P);
  segment.set_strategy_source(v1::STRATEGY_SOURCE_LEARNED);
  for (const double coordinate : {1.0, 2.0, 3.0}) segment.add_path_in_map(coordinate);
  return segment;
}

void ExpectNamed(const v1::Segment& segment, const std::string& field) {
  const Status status = RemoteSegmentFromProto(segment).status();
  EXPECT_EQ(status.code(), StatusCode::kInternal);
  EXPECT_NE(status.message().find(field + ": "), std::string::npos) << status.message();
}

TEST(RemoteSegmentFromProto, NamesTheFieldThatIsWrong) {
  ASSERT_TRUE(RemoteSegmentFromProto(GoodSegment()).ok());
  v1::Segment segment = GoodSegment();
  segment.set_strategy(static_cast<v1::Strategy>(99));
  ExpectNamed(segment, "segment.strategy");
  segment = GoodSegment();
  segment.set_strategy_source(static_cast<v1::StrategySource>(99));
  ExpectNamed(segment, "segment.strategy_source");
  segment = GoodSegment();
  segment.add_path_in_map(4.0);
  ExpectNamed(segment, "segment.path_in_map");
}

TEST(RemoteSegmentFromProto, RefusesNumbersThatAreNone) {
  v1::Segment segment = GoodSegment();
  segment.set_path_in_map(1, kNan);
  ExpectNamed(segment, "segment.path_in_map[1]");
  segment = GoodSegment();
  segment.set_point_inlier_ratio(kNan);
  ExpectNamed(segment, "segment.point_inlier_ratio");
  segment = GoodSegment();
  segment.set_line_inlier_ratio(-0.5);
  ExpectNamed(segment, "segment.line_inlier_ratio");
}

}  // namespace
}  // namespace maploc
