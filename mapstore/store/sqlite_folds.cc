#include "mapstore/store/sqlite_folds.h"

#include <span>
#include <string>
#include <string_view>

#include "mapstore/base/random.h"
#include "mapstore/store/little_endian.h"

namespace maploc {
namespace {

using Bytes = std::vector<std::uint8_t>;

// One list for writing and reading. Its order is the format of the blob (FORMAT.md).
template <typename State, typename Visitor>
void ForEachNumber(State& state, const Visitor& visit) {
  auto& sums = state.sums;
  visit(sums.sessions), visit(sums.queries), visit(sums.localized);
  const auto visit_proportion = [&](auto& share) {
    visit(share.good), visit(share.total), visit(share.independent);
  };
  for (auto& sum : sums.shares) visit_proportion(sum.share), visit(sum.sessions);
  for (auto& scatter : sums.scatters) visit(scatter.sum), visit(scatter.weight);
  visit_proportion(sums.usable_lines);
  visit_proportion(sums.vertical_lines);
  visit(sums.point_medians), visit(sums.usable_line_medians), visit(sums.vertical_line_medians);
  visit(state.previous), visit(state.current);
}

std::uint64_t HashOf(std::span<const std::uint8_t> bytes) {
  return HashBytes(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

Bytes Encode(const SelectorState& state) {
  Bytes bytes;
  ForEachNumber(state, [&](const auto& number) { AppendLittleEndian(number, bytes); });
  AppendLittleEndian(HashOf(bytes), bytes);
  return bytes;
}

std::optional<SelectorState> Decode(std::span<const std::uint8_t> bytes) {
  static const std::size_t size = Encode({}).size();
  // Every number has a fixed width, so a blob of another length is damaged.
  if (bytes.size() != size) return std::nullopt;
  const std::size_t hash_at = size - sizeof(std::uint64_t);
  if (HashOf(bytes.first(hash_at)) != ReadLittleEndian<std::uint64_t>(&bytes[hash_at])) {
    return std::nullopt;
  }
  SelectorState state;
  const std::uint8_t* next = bytes.data();
  ForEachNumber(state, [&]<typename T>(T& number) {
    number = ReadLittleEndian<T>(next);
    next += sizeof(T);
  });
  return state;
}

constexpr std::string_view kColumns =
    "map, segment, start_unix_ns, session, sessions, options, row_options, state";

// Nothing where it is damaged.
std::optional<FoldCheckpoint> CheckpointAt(const SqliteStatement& row) {
  FoldCheckpoint checkpoint;
  checkpoint.position = {row.Int("start_unix_ns"), row.Text("session")};
  checkpoint.options = row.Int("options");
  checkpoint.row_options = row.Int("row_options");
  const auto state = Decode(row.Bytes("state"));
  if (!state) return std::nullopt;
  checkpoint.state = *state;
  return checkpoint;
}

std::string SelectAnd(std::string_view order) {
  return "SELECT " + std::string(kColumns) +
         " FROM segment_folds WHERE map = ?1 AND segment = ?2 ORDER BY " + std::string(order);
}

}  // namespace

Result<std::optional<FoldCheckpoint>> ReadLastCheckpoint(SqliteDatabase& database, std::int64_t map,
                                                         SegmentId id) {
  SqliteStatement last(database, SelectAnd("start_unix_ns DESC, session DESC LIMIT 1"));
  MAPLOC_ASSIGN_OR_RETURN(const bool found, last.Bind(map, id).Step());
  return found ? CheckpointAt(last) : std::nullopt;
}

Result<std::vector<FoldCheckpoint>> ReadCheckpoints(SqliteDatabase& database, std::int64_t map,
                                                    SegmentId id) {
  SqliteStatement all(database, SelectAnd("start_unix_ns, session"));
  MAPLOC_ASSIGN_OR_RETURN(const auto read, all.Bind(map, id).Collect(CheckpointAt));
  std::vector<FoldCheckpoint> checkpoints;
  for (const auto& checkpoint : read) {
    if (!checkpoint) {
      return Status(
          StatusCode::kDataLoss, "DAMAGED_STORE",
          "segment " + std::to_string(id) + ": a checkpoint of its statistics is damaged");
    }
    checkpoints.push_back(*checkpoint);
  }
  return checkpoints;
}

Status InsertCheckpoint(SqliteDatabase& database, std::int64_t map, SegmentId id,
                        const FoldCheckpoint& checkpoint) {
  const std::string columns(kColumns);
  SqliteStatement insert(database, "INSERT OR REPLACE INTO segment_folds (" + columns +
                                       ") VALUES " + ParametersFor(columns));
  return insert
      .Bind(map, id, checkpoint.position.session_start_unix_ns, checkpoint.position.session,
            checkpoint.state.sums.sessions, checkpoint.options, checkpoint.row_options,
            Encode(checkpoint.state))
      .Run();
}

Status DeleteCheckpoint(SqliteDatabase& database, std::int64_t map, SegmentId id,
                        const FoldPosition& position) {
  SqliteStatement remove(database,
                         "DELETE FROM segment_folds WHERE map = ?1 AND segment = ?2 AND "
                         "start_unix_ns = ?3 AND session = ?4");
  return remove.Bind(map, id, position.session_start_unix_ns, position.session).Run();
}

Status DeleteCheckpointsFrom(SqliteDatabase& database, std::int64_t map, SegmentId id,
                             const FoldPosition& from) {
  SqliteStatement remove(database,
                         "DELETE FROM segment_folds WHERE map = ?1 AND segment = ?2 AND "
                         "(start_unix_ns, session) >= (?3, ?4)");
  return remove.Bind(map, id, from.session_start_unix_ns, from.session).Run();
}

}  // namespace maploc
