#include "server/pipeline/query_check.h"

#include <string>
#include <string_view>
#include <vector>

#include "mapstore/base/random.h"

namespace maploc {
namespace {

Status CheckKind(std::string_view what, const Descriptors& sent, const DescriptorKind& of_map) {
  if (sent.size() == 0 || of_map.name.empty() || sent.kind == of_map) return Status::Ok();
  return FailedPrecondition("DESCRIPTOR_KIND_MISMATCH",
                            std::string(what) + ": the query's kind is " + ToText(sent.kind) +
                                ", the map's is " + ToText(of_map) +
                                "; GetMap returns the map's kinds: send descriptors of these");
}

template <typename T>
std::uint64_t HashArray(const T* values, std::size_t count, std::uint64_t seed) {
  return HashBytes({reinterpret_cast<const char*>(values), count * sizeof(T)}, seed);
}

std::uint64_t HashPixels(const std::vector<Eigen::Vector2f>& pixels, std::uint64_t seed) {
  return pixels.empty() ? seed : HashArray(pixels.front().data(), 2 * pixels.size(), seed);
}

}  // namespace

Status CheckQuery(const Query& query, const MapInfo& map) {
  if (query.views.size() != 1) {
    return InvalidArgument("views", "exactly one view is served, " +
                                        std::to_string(query.views.size()) + " were sent");
  }
  const View& view = query.views.front();
  MAPLOC_RETURN_IF_ERROR(
      CheckKind("views[0].points", view.points.descriptors, map.point_descriptor));
  return CheckKind("views[0].lines", view.lines.descriptors, map.line_descriptor);
}

std::uint64_t ContentHash(const Query& query) {
  std::uint64_t hash = HashBytes(query.map);
  if (query.gravity) hash = HashArray(query.gravity->direction_in_body.data(), 3, hash);
  for (const View& view : query.views) {
    hash = HashPixels(view.points.keypoints_px, hash);
    hash = HashPixels(view.lines.starts_px, hash);
    hash = HashPixels(view.lines.ends_px, hash);
  }
  return hash;
}

}  // namespace maploc
