#include "mapstore/store/sqlite_database.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc::testing {
namespace {

class SqliteStatementTest : public ::testing::Test {
 protected:
  const TemporaryFolder folder_;
  SqliteDatabase database_ =
      SqliteDatabase::Open(folder_.File("file"), SqliteAccess::kCreate, 0).value();
};

TEST_F(SqliteStatementTest, ReadsColumnsByNameInAnyOrderInEveryRow) {
  SqliteStatement statement(database_,
                            "SELECT t.a, t.a + 1 AS b, t.a + 2 AS c FROM "
                            "(SELECT 1 AS a UNION SELECT 2 UNION SELECT 3) t WHERE t.a < ?1");
  for (const std::int64_t end : {4, 3}) {
    statement.Bind(end);
    for (std::int64_t a = 1; a < end; ++a) {
      ASSERT_TRUE(statement.Step().value());
      EXPECT_EQ(statement.Int("c"), a + 2);
      EXPECT_EQ(statement.Int("a"), a);
      EXPECT_EQ(statement.Int("b"), a + 1);
      if (a == 2) {  // a read that other rows lack
        EXPECT_EQ(statement.Int("b"), a + 1);
      }
    }
    EXPECT_FALSE(statement.Step().value());
  }
}

TEST_F(SqliteStatementTest, ColumnThatIsNotThereThrows) {
  SqliteStatement statement(database_, "SELECT 1 AS a, 2 AS b");
  ASSERT_TRUE(statement.Step().value());
  EXPECT_EQ(statement.Int("b"), 2);
  EXPECT_THROW(statement.Int("c"), std::logic_error);
  EXPECT_EQ(statement.Int("a"), 1);
}

TEST_F(SqliteStatementTest, TwoColumnsOfOneNameThrow) {
  SqliteStatement statement(database_, "SELECT 1 AS a, 2 AS b, 3 AS a");
  ASSERT_TRUE(statement.Step().value());
  EXPECT_THROW(statement.Int("b"), std::logic_error);
}

}  // namespace
}  // namespace maploc::testing
