#include "server/ransac/draw_pool.h"

#include <algorithm>
#include <cmath>

namespace maploc {
namespace {

constexpr double kDrawsAMatch = 0.5;  // T_N / N

}  // namespace

DrawPool::DrawPool(std::uint32_t matches, bool has_quality)
    : draws_to_all_(kDrawsAMatch * matches) {
  // With a T_N of one draw or less the share would begin above one.
  if (has_quality && draws_to_all_ > 1.0) share_ = std::sqrt(draws_ / draws_to_all_);
}

void DrawPool::Advance() {
  if (share_ >= 1.0) return;
  draws_ += 1.0;
  share_ = std::min(1.0, std::sqrt(draws_ / draws_to_all_));
}

std::uint32_t DrawPool::SizeOf(std::uint32_t count) const {
  if (share_ >= 1.0) return count;
  const auto size = static_cast<std::uint32_t>(std::ceil(share_ * count));
  return std::min(count, std::max(size, kLeast));
}

}  // namespace maploc
