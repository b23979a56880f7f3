// A small world to put into a store, in the words of a small language: GiveMap, Visit, End.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/store/in_memory_store.h"
#include "mapstore/store/sqlite_store.h"

namespace maploc::testing {

inline MapInfo YardInfo(const std::string& name = "yard") {
  MapInfo info;
  info.key.name = name;
  info.metric = true;
  info.map_from_source.scale = 0.1;  // not a binary fraction, so that a lossy store shows
  info.map_from_source.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  info.map_from_source.translation = {1.0 / 3.0, -2.0, 3e-5};
  info.point_descriptor = {"orb", 32, DescriptorMetric::kHamming};
  info.line_descriptor = {"lbd", 32, DescriptorMetric::kHamming};
  info.created_unix_ns = 1'700'000'000'123'456'789;
  return info;
}

// Segment `id` of the yard: points 100 id ... 100 id + 119, so that neighbours share 20; two lines
// of its own, one of them vertical, and one usable line (9999) that every segment sees.
inline Segment YardSegment(SegmentId id) {
  Segment segment;
  segment.id = id;
  segment.path_in_map = {{10.0 * id, 0.0, 1.5}, {10.0 * id + 5.0, 0.1, 1.5}};
  for (int i = 0; i < 120; ++i) {
    const LandmarkId landmark = 100 * id + i;
    segment.points.ids.push_back(landmark);
    segment.points.positions_in_map.push_back(
        {0.1 * static_cast<double>(landmark), 4.0 / 3.0, 0.7});
    for (int copy = 0; copy <= i % 2; ++copy) segment.points.descriptor_landmark.push_back(i);
  }
  segment.points.descriptors.kind = YardInfo().point_descriptor;
  segment.points.descriptors.bytes.resize(segment.points.descriptor_landmark.size() * 32);
  for (std::size_t i = 0; i < segment.points.descriptors.bytes.size(); ++i) {
    segment.points.descriptors.bytes[i] = static_cast<std::uint8_t>(i * 7 + id);
  }
  segment.lines.ids = {2 * id, 2 * id + 1, 9999};
  segment.lines.segments_in_map = {
      {{0, 5, 0}, {0, 5, 3}}, {{0, 5, 3}, {2, 5, 3}}, {{1, 1, 1}, {9, 1, 1}}};
  segment.lines.descriptor_landmark = {0, 1, 1, 2};
  segment.lines.descriptors.kind = YardInfo().line_descriptor;
  segment.lines.descriptors.bytes.assign(4 * 32, static_cast<std::uint8_t>(id));
  return segment;
}

// The same, with from where its landmarks were seen: of every third, nothing is known.
inline Segment SeenYardSegment(SegmentId id) {
  Segment segment = YardSegment(id);
  const auto range = [](int i) {
    if (i % 3 == 0) return ViewingRange{};
    const float distance = 0.1f * static_cast<float>(i);
    return ViewingRange{{0.6f, 0, -0.8f}, 0.01f * static_cast<float>(i), distance, 2 * distance};
  };
  for (int i = 0; i < segment.points.size(); ++i) segment.points.viewing.push_back(range(i));
  for (int i = 0; i < segment.lines.size(); ++i) segment.lines.viewing.push_back(range(i));
  return segment;
}

inline MapKey GiveMap(MapStore& store, const std::string& name = "yard", int segments = 3) {
  auto writer = store.BeginImport(YardInfo(name));
  EXPECT_TRUE(writer.ok()) << writer.status().ToString();
  for (int id = 0; id < segments; ++id) {
    const Status added = (*writer)->AddSegment(YardSegment(id));
    EXPECT_TRUE(added.ok()) << added.ToString();
  }
  const Status committed = (*writer)->Commit();
  EXPECT_TRUE(committed.ok()) << committed.ToString();
  return (*writer)->key();
}

inline Session OpenSession(const std::string& id, const MapKey& map, std::int64_t start = 1000) {
  Session session;
  session.id = id;
  session.map = map;
  session.robot = "r2";
  session.labels = {{"light", "night"}, {"season", "autumn"}};
  session.start_unix_ns = start;
  return session;
}

// A localized query in `segment`.
inline Observation Seen(std::int64_t sequence, SegmentId segment, int point_matches = 40,
                        int point_inliers = 30, int line_matches = 10, int line_inliers = 4) {
  Observation observation;
  observation.sequence = sequence;
  observation.segment = segment;
  observation.outcome = Outcome::kLocalized;
  observation.evidence.points = {point_matches, point_inliers};
  observation.evidence.usable_lines = {line_matches, line_inliers};
  observation.evidence.vertical_lines = {5, 2};
  observation.evidence.strategy = Strategy::k2P;
  observation.evidence.fell_back = true;
  observation.evidence.iterations = 17;
  observation.evidence.gravity_disagreement_rad = 0.01;
  observation.evidence.gravity_tilt_rad = {0.006, -0.008};
  observation.evidence.confidence = 0.999;
  observation.evidence.inlier_rms_px = 0.7;
  observation.evidence.gravity_rejected = true;
  observation.total_ms = 4.2;
  observation.time_unix_ns = 2000 + sequence;
  return observation;
}

// A query that failed; with matches, which must not enter any ratio.
inline Observation Missed(std::int64_t sequence, SegmentId segment) {
  Observation observation = Seen(sequence, segment, 50, 3, 9, 0);
  observation.outcome = Outcome::kNoConsensus;
  return observation;
}

inline Observation OutOfMap(std::int64_t sequence) {
  Observation observation;
  observation.sequence = sequence;
  observation.outcome = Outcome::kOutOfMap;
  return observation;
}

// To one session, which must be open.
inline Status Append(MapStore& store, const SessionId& id, std::vector<Observation> observations) {
  const auto ended =
      store.AppendGroup(std::vector<SessionObservations>{{id, std::move(observations)}});
  if (!ended.ok()) return ended.status();
  return ended->empty() ? Status::Ok() : FailedPrecondition("ENDED", "session '" + id + "'");
}

}  // namespace maploc::testing
