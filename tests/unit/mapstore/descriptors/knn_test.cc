#include "mapstore/descriptors/knn.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <hwy/targets.h>

#include "mapstore/descriptors/distance_kernels.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

DescriptorKind Kind(DescriptorMetric metric, int bytes) { return {"test", bytes, metric}; }

// `spread`: how many low bits vary. A small one makes ties frequent.
Descriptors RandomDescriptors(const DescriptorKind& kind, int count, Random& random, int spread) {
  Descriptors result{kind, {}};
  for (int i = 0; i < count * kind.bytes; ++i) {
    result.bytes.push_back(static_cast<std::uint8_t>(random.Below(1u << spread)));
  }
  return result;
}

// One to four rows a landmark.
std::vector<std::int32_t> RandomLandmarks(int rows, Random& random) {
  std::vector<std::int32_t> landmarks;
  for (std::int32_t landmark = 0; static_cast<int>(landmarks.size()) < rows; ++landmark) {
    const int copies = 1 + static_cast<int>(random.Below(4));
    landmarks.insert(landmarks.end(), copies, landmark);
  }
  landmarks.resize(rows);
  return landmarks;
}

std::uint32_t NaiveDistance(const Descriptors& a, int i, const Descriptors& b, int j) {
  std::uint32_t distance = 0;
  for (int k = 0; k < a.kind.bytes; ++k) {
    const int x = a.row(i)[k], y = b.row(j)[k];
    distance += a.kind.metric == DescriptorMetric::kHamming
                    ? static_cast<std::uint32_t>(__builtin_popcount(x ^ y))
                    : static_cast<std::uint32_t>((x - y) * (x - y));
  }
  return distance;
}

// Distance of a query to each landmark, by the definition.
std::map<std::int32_t, std::uint32_t> LandmarkDistances(const Descriptors& queries, int query,
                                                        const Descriptors& database,
                                                        const std::vector<std::int32_t>& owner) {
  std::map<std::int32_t, std::uint32_t> distances;
  for (int row = 0; row < database.size(); ++row) {
    const std::uint32_t d = NaiveDistance(queries, query, database, row);
    const auto [at, added] = distances.emplace(owner[row], d);
    if (!added) at->second = std::min(at->second, d);
  }
  return distances;
}

Neighbours NaiveNeighbours(const std::map<std::int32_t, std::uint32_t>& distances) {
  Neighbours result;
  for (const auto& [landmark, d] : distances) {
    if (result.best < 0 || d < result.best_distance) {
      result.best = landmark;
      result.best_distance = d;
    }
  }
  for (const auto& [landmark, d] : distances) {
    if (landmark != result.best) result.second_distance = std::min(result.second_distance, d);
  }
  return result;
}

struct Case {
  DescriptorMetric metric;
  int bytes;
  int queries;
  int rows;
  int spread;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << (c.metric == DescriptorMetric::kHamming ? "Hamming" : "L2") << c.bytes << "bytes"
       << c.queries << "x" << c.rows << "spread" << c.spread;
}

struct Sides {
  Descriptors queries;
  Descriptors database;
  std::vector<std::int32_t> owner;  // the landmark of a row of the database
};

Sides MakeSides(const Case& c) {
  Random random = testing::TestRandom();
  const DescriptorKind kind = Kind(c.metric, c.bytes);
  Descriptors queries = RandomDescriptors(kind, c.queries, random, c.spread);
  Descriptors database = RandomDescriptors(kind, c.rows, random, c.spread);
  return {std::move(queries), std::move(database), RandomLandmarks(c.rows, random)};
}

// Every instruction set that this machine has must give the naive answer.
class KnnTest : public ::testing::TestWithParam<Case> {
 protected:
  void TearDown() override { Choose(0); }

  // Highway knows targets that it does not generate code for; those are passed over.
  void ForEachTarget(const std::function<void()>& body) {
    int targets_run = 0;
    const std::int64_t all = hwy::SupportedTargets();
    for (std::int64_t left = all; left != 0; left &= left - 1) {
      const std::int64_t target = left & -left;
      SCOPED_TRACE(hwy::TargetName(target));
      Choose(target);
      if (hwy::TargetName(target) != std::string(kernels::KernelTargetName())) continue;
      ++targets_run;
      body();
    }
    EXPECT_GE(targets_run, 2);
  }

 private:
  // 0: all that the machine has.
  static void Choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST_P(KnnTest, EqualsTheDefinitionOnEveryInstructionSet) {
  const Case c = GetParam();
  const Sides sides = MakeSides(c);
  const Descriptors& queries = sides.queries;
  const Descriptors& database = sides.database;
  const std::vector<std::int32_t>& owner = sides.owner;
  ForEachTarget([&] {
    const std::vector<Neighbours> found = FindNeighbours(queries, database, owner);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(c.queries));
    for (int q = 0; q < c.queries; ++q) {
      const Neighbours want = NaiveNeighbours(LandmarkDistances(queries, q, database, owner));
      ASSERT_EQ(found[q].best, want.best) << "query " << q;
      ASSERT_EQ(found[q].best_distance, want.best_distance) << "query " << q;
      ASSERT_EQ(found[q].second_distance, want.second_distance) << "query " << q;
    }
  });
}

TEST_P(KnnTest, MutualMatchesAreNearestBothWays) {
  const Case c = GetParam();
  const Sides sides = MakeSides(c);
  const Descriptors& queries = sides.queries;
  const Descriptors& database = sides.database;
  const std::vector<std::int32_t>& owner = sides.owner;
  const double max_ratio = 0.95;

  std::map<std::int32_t, std::pair<std::uint32_t, int>> nearest_query;  // by landmark
  std::vector<Neighbours> nearest_landmark;
  for (int q = 0; q < c.queries; ++q) {
    const auto distances = LandmarkDistances(queries, q, database, owner);
    nearest_landmark.push_back(NaiveNeighbours(distances));
    for (const auto& [landmark, d] : distances) {
      const auto [at, added] = nearest_query.emplace(landmark, std::pair(d, q));
      if (!added) at->second = std::min(at->second, std::pair(d, q));
    }
  }
  std::vector<std::pair<int, int>> want;
  for (int q = 0; q < c.queries; ++q) {
    const Neighbours& n = nearest_landmark[q];
    if (n.best < 0 || nearest_query[n.best].second != q) continue;
    double ratio =
        n.second_distance == 0 ? 1.0 : static_cast<double>(n.best_distance) / n.second_distance;
    if (c.metric == DescriptorMetric::kL2U8) ratio = std::sqrt(ratio);
    if (n.second_distance == UINT32_MAX || ratio <= static_cast<double>(0.95f)) {
      want.emplace_back(q, n.best);
    }
  }
  std::vector<std::pair<int, int>> got;
  for (const FeatureMatch& m :
       MatchDescriptors(queries, database, owner, {.max_ratio = static_cast<float>(max_ratio)})) {
    got.emplace_back(m.feature, m.landmark);
  }
  EXPECT_EQ(got, want);
}

// A part of the queries gets what it gets among all of them: the way back is against all.
TEST_P(KnnTest, SomeQueriesMatchAsAmongAll) {
  const Sides sides = MakeSides(GetParam());
  const MatchOptions options{.max_ratio = 0.95f};
  std::vector<std::int32_t> asked;
  for (int q = 0; q < sides.queries.size(); q += 3) asked.push_back(q);
  std::vector<std::pair<int, int>> want, got;
  for (const FeatureMatch& m :
       MatchDescriptors(sides.queries, sides.database, sides.owner, options)) {
    if (m.feature % 3 == 0) want.emplace_back(m.feature, m.landmark);
  }
  for (const FeatureMatch& m :
       MatchSome(sides.queries, asked, sides.database, sides.owner, options)) {
    got.emplace_back(m.feature, m.landmark);
  }
  EXPECT_EQ(got, want);
}

TEST_P(KnnTest, ADistanceIsTheDefinitionsOnEveryInstructionSet) {
  const Sides sides = MakeSides(GetParam());
  const DescriptorKind& kind = sides.queries.kind;
  ForEachTarget([&] {
    for (int row = 0; row < sides.database.size(); ++row) {
      const Descriptors one{kind, {sides.database.row(row).begin(), sides.database.row(row).end()}};
      const auto naive = LandmarkDistances(sides.queries, 0, one, {7});
      ASSERT_EQ(DescriptorDistance(kind.metric, sides.queries.row(0), one.row(0)), naive.at(7));
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, KnnTest,
                         ::testing::Values(Case{DescriptorMetric::kHamming, 32, 67, 1203, 8},
                                           Case{DescriptorMetric::kHamming, 48, 5, 700, 8},
                                           Case{DescriptorMetric::kHamming, 1, 9, 300, 8},
                                           Case{DescriptorMetric::kHamming, 33, 4, 129, 8},
                                           Case{DescriptorMetric::kHamming, 512, 6, 40, 8},
                                           Case{DescriptorMetric::kHamming, 32, 50, 400, 1},
                                           Case{DescriptorMetric::kHamming, 32, 3, 1, 8},
                                           Case{DescriptorMetric::kL2U8, 128, 66, 1111, 8},
                                           Case{DescriptorMetric::kL2U8, 33, 7, 250, 8},
                                           Case{DescriptorMetric::kL2U8, 1, 8, 90, 8},
                                           Case{DescriptorMetric::kL2U8, 512, 5, 70, 8},
                                           Case{DescriptorMetric::kL2U8, 128, 31, 333, 1},
                                           Case{DescriptorMetric::kL2U8, 48, 1, 17, 8}));

// The largest distance there is: 512 bytes, all 0 against all 255.
TEST(KnnExtremesTest, LargestDistanceDoesNotOverflow) {
  const DescriptorKind kind = Kind(DescriptorMetric::kL2U8, 512);
  const Descriptors queries{kind, std::vector<std::uint8_t>(512, 255)};
  const Descriptors database{kind, std::vector<std::uint8_t>(512, 0)};
  const auto found = FindNeighbours(queries, database, std::vector<std::int32_t>{0});
  EXPECT_EQ(found[0].best, 0);
  EXPECT_EQ(found[0].best_distance, 512u * 255u * 255u);
  EXPECT_EQ(found[0].second_distance, UINT32_MAX);
}

TEST(KnnEmptyTest, NothingMatchesNothing) {
  const DescriptorKind kind = Kind(DescriptorMetric::kHamming, 32);
  Random random = testing::TestRandom();
  const Descriptors some = RandomDescriptors(kind, 5, random, 8);
  const Descriptors none{kind, {}};
  const Descriptors without_kind;
  const std::vector<std::int32_t> owner = {0, 1, 2, 3, 4};
  EXPECT_TRUE(FindNeighbours(none, some, owner).empty());
  EXPECT_TRUE(MatchDescriptors(none, some, owner).empty());
  EXPECT_TRUE(MatchDescriptors(some, none, {}).empty());
  EXPECT_TRUE(MatchDescriptors(without_kind, without_kind, {}).empty());
  ASSERT_EQ(FindNeighbours(some, none, {}).size(), 5u);
  EXPECT_EQ(FindNeighbours(some, none, {})[0].best, -1);
}

TEST(MatchOptionsTest, TwinsOfAnotherLandmarkFailTheRatioAndOfTheSamePass) {
  const DescriptorKind kind = Kind(DescriptorMetric::kHamming, 4);
  const Descriptors query{kind, {1, 2, 3, 4}};
  const Descriptors twins{kind, {1, 2, 3, 4, 1, 2, 3, 4, 255, 255, 255, 255}};
  EXPECT_TRUE(MatchDescriptors(query, twins, std::vector<std::int32_t>{0, 1, 2}).empty());
  const auto same = MatchDescriptors(query, twins, std::vector<std::int32_t>{0, 0, 1});
  ASSERT_EQ(same.size(), 1u);
  EXPECT_EQ(same[0].landmark, 0);
  EXPECT_EQ(same[0].ratio, 0.0f);
}

}  // namespace
}  // namespace maploc
