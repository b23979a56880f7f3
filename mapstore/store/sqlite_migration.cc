#include "mapstore/store/sqlite_migration.h"

#include <span>

namespace maploc {
namespace {

// The hash (FNV-1a, HashBytes) of what stood before `last`, from the hash of both. A step is hash =
// (hash ^ byte) * prime; the prime is odd, so it has an inverse modulo 2^64 and each step can be
// undone.
std::uint64_t HashBefore(std::span<const std::uint8_t> last, std::uint64_t hash) {
  constexpr std::uint64_t kInverseOfPrime = 0xce965057aff6957bull;
  static_assert(kInverseOfPrime * 0x100000001b3ull == 1);
  for (auto byte = last.rbegin(); byte != last.rend(); ++byte) {
    hash = hash * kInverseOfPrime ^ *byte;
  }
  return hash;
}

struct Row {
  std::int64_t id = 0;
  std::int64_t checksum = 0;  // of what is left
};

Row RowAt(const SqliteStatement& row) {
  const auto checksum = static_cast<std::uint64_t>(row.Int("checksum"));
  return {row.Int("rowid"),
          static_cast<std::int64_t>(HashBefore(row.Bytes("covariances"), checksum))};
}

}  // namespace

Status TakeCovariancesOffChecksums(SqliteDatabase& database) {
  SqliteStatement known(database,
                        "SELECT rowid, checksum, covariances FROM segment_features "
                        "WHERE length(covariances) > 0");
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<Row> rows, known.Collect(RowAt));
  SqliteStatement update(database, "UPDATE segment_features SET checksum = ?2 WHERE rowid = ?1");
  for (const Row& row : rows) MAPLOC_RETURN_IF_ERROR(update.Bind(row.id, row.checksum).Run());
  return Status::Ok();
}

}  // namespace maploc
