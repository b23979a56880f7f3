// Distances of a few query descriptors to a tile of database rows: the inner loops of knn.h, behind
// Highway's run-time dispatch over plain arrays.
//
// A tile holds rows transposed in chunks of kChunkRows, so that one vector lane is one row and no
// sum ever crosses lanes. The layouts belong to the processor that runs, hence pack and compute in
// one process; nothing here is stored. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mapstore/model/descriptor.h"

namespace maploc::kernels {

inline constexpr int kBlockQueries = 4;  // queries that share a pass over a tile
inline constexpr int kChunkRows = 16;    // rows of a tile are padded to a multiple of this

// Bytes that one packed row or query takes at most, for any layout; row_bytes <=
// kMaxDescriptorBytes.
constexpr std::size_t PackedBytes(int row_bytes) {
  return 2 * ((static_cast<std::size_t>(row_bytes) + 7) / 8 * 8);
}

// Packs `count` descriptors as database rows. `tile` has room for RoundUp(count, kChunkRows) rows
// of PackedBytes; `constants` for as many numbers (what a row adds to each of its distances).
void PackRows(DescriptorMetric metric, const std::uint8_t* rows, int count, int row_bytes,
              std::uint8_t* tile, std::int32_t* constants);

// Packs one block of `count` <= kBlockQueries queries; missing ones are packed as zeros. `block`
// has room for kBlockQueries rows of PackedBytes.
void PackQueries(DescriptorMetric metric, const std::uint8_t* queries, int count, int row_bytes,
                 std::uint8_t* block, std::int32_t* constants);

// distances[q * row_stride + r] for all q < kBlockQueries and r < RoundUp(row_count, kChunkRows);
// those of padding mean nothing. row_stride is a multiple of kChunkRows.
void ComputeDistances(DescriptorMetric metric, int row_bytes, const std::uint8_t* block,
                      const std::int32_t* block_constants, const std::uint8_t* tile,
                      const std::int32_t* row_constants, int row_count, std::size_t row_stride,
                      std::uint32_t* distances);

// The instruction set that runs, for reports: "AVX3_DL", "AVX2", ...
const char* KernelTargetName();

}  // namespace maploc::kernels
