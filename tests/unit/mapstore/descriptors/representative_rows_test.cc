#include "mapstore/descriptors/representative_rows.h"

#include <gmock/gmock.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::IsEmpty;

const DescriptorKind kBinary{"orb", 32, DescriptorMetric::kHamming};
const DescriptorKind kSift{"sift_root_u8", 128, DescriptorMetric::kL2U8};

void Append(Descriptors& rows, std::uint8_t value, int noise, Random& random) {
  for (int i = 0; i < rows.kind.bytes; ++i) {
    rows.bytes.push_back(static_cast<std::uint8_t>(value ^ random.Below(noise + 1)));
  }
}

// A landmark by day and by night: each look must be represented, whatever their numbers.
TEST(RepresentativeRowsTest, TwoLooksAreEachRepresented) {
  for (const DescriptorKind& kind : {kBinary, kSift}) {
    Random random = testing::TestRandom();
    Descriptors rows{kind, {}};
    for (int i = 0; i < 9; ++i) Append(rows, 0x00, 7, random);
    for (int i = 0; i < 3; ++i) Append(rows, 0xf0, 7, random);
    const std::vector<int> chosen = RepresentativeRows(rows, 0, 12);
    ASSERT_EQ(chosen.size(), 2u) << kind.name;
    EXPECT_LT(chosen[0], 9) << kind.name;
    EXPECT_GE(chosen[1], 9) << kind.name;
  }
}

TEST(RepresentativeRowsTest, AnOutlierIsNotTheOneThatStandsForAll) {
  const DescriptorKind kind{"x", 1, DescriptorMetric::kL2U8};
  const Descriptors rows{kind, {200, 9, 10, 11, 12}};
  EXPECT_THAT(RepresentativeRows(rows, 0, 5), ElementsAre(0, 3));  // 200, and the median 11
  EXPECT_THAT(RepresentativeRows(rows, 1, 5), ::testing::SizeIs(2));
}

TEST(RepresentativeRowsTest, FewRowsAreAllKeptAndEqualOnesOnce) {
  const DescriptorKind kind{"x", 1, DescriptorMetric::kHamming};
  const Descriptors rows{kind, {1, 2, 7, 7, 7}};
  EXPECT_THAT(RepresentativeRows(rows, 0, 0), IsEmpty());
  EXPECT_THAT(RepresentativeRows(rows, 0, 2), ElementsAre(0, 1));
  EXPECT_THAT(RepresentativeRows(rows, 2, 5), ElementsAre(2));
}

TEST(RepresentativeRowsTest, ALongTrackIsSampledOverItsWholeLength) {
  Random random = testing::TestRandom();
  Descriptors rows{kBinary, {}};
  for (int i = 0; i < 500; ++i) Append(rows, i < 250 ? 0x00 : 0xf0, 7, random);
  const std::vector<int> chosen = RepresentativeRows(rows, 100, 500);
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_THAT(chosen, Each(Ge(100)));
  EXPECT_LT(chosen[0], 250);
  EXPECT_GE(chosen[1], 250);
}

}  // namespace
}  // namespace maploc
