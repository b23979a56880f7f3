// Exact nearest neighbours of descriptors, and the ratio and mutual tests. Wide kernels by Google
// Highway's run-time dispatch over plain bytes. Deterministic; thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mapstore/descriptors/neighbours.h"
#include "mapstore/model/descriptor.h"
#include "mapstore/model/matches.h"

namespace maploc {

struct MatchOptions {
  float max_ratio = 0.8f;  // of distances (not squared): best <= max_ratio * second
  bool mutual = true;
};

// For each row of `queries`. `row_landmark` maps database rows to landmarks (ascending). REQUIRES:
// equal kinds; row_landmark.size() == database.size().
std::vector<Neighbours> FindNeighbours(const Descriptors& queries, const Descriptors& database,
                                       std::span<const std::int32_t> row_landmark);

// Best distance over second best (not squared); 1 where there is no other landmark to compare with,
// or where both distances are 0.
double RatioOf(const Neighbours& neighbours, DescriptorMetric metric);

// Whether there is a neighbour, and it is the only landmark or has a ratio of at most `max_ratio`.
bool PassesRatio(const Neighbours& neighbours, DescriptorMetric metric, float max_ratio);

// MatchDescriptors' matches of what FindNeighbours found.
std::vector<FeatureMatch> MatchNeighbours(std::span<const Neighbours> neighbours,
                                          const Descriptors& queries, const Descriptors& database,
                                          std::span<const std::int32_t> row_landmark,
                                          const MatchOptions& options = {});

// At most one match a feature and one a landmark, ascending by feature.
std::vector<FeatureMatch> MatchDescriptors(const Descriptors& queries, const Descriptors& database,
                                           std::span<const std::int32_t> row_landmark,
                                           const MatchOptions& options = {});

// Those of MatchDescriptors' matches whose features are `asked` (ascending), for their share of its
// time: the mutual test is against all of `queries`.
std::vector<FeatureMatch> MatchSome(const Descriptors& queries, std::span<const std::int32_t> asked,
                                    const Descriptors& database,
                                    std::span<const std::int32_t> row_landmark,
                                    const MatchOptions& options = {});

// Between two rows of one kind, as Neighbours' distances. REQUIRES: equal sizes.
std::uint32_t DescriptorDistance(DescriptorMetric metric, std::span<const std::uint8_t> a,
                                 std::span<const std::uint8_t> b);

}  // namespace maploc
