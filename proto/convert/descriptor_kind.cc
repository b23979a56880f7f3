#include "mapstore/base/name.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc {

Result<DescriptorKind> DescriptorKindFromProto(const v1::DescriptorKind& kind,
                                               const std::string& field) {
  MAPLOC_RETURN_IF_ERROR(CheckName(field + ".name", kind.name()));
  // A view without lines, or a map without points, has no kind: all three fields are then unset.
  // One that is set alone is a client that forgot the name.
  if (kind.name().empty()) {
    if (kind.bytes_count() == 0 && kind.metric() == v1::DESCRIPTOR_METRIC_UNSPECIFIED) {
      return DescriptorKind{};
    }
    return InvalidArgument(field + ".name", "is required", "REQUIRED");
  }
  if (kind.bytes_count() < 1 || kind.bytes_count() > kMaxDescriptorBytes) {
    return InvalidArgument(field + ".bytes_count", "must be in [1, 512]", "OUT_OF_RANGE");
  }
  if (kind.metric() != v1::DESCRIPTOR_METRIC_HAMMING &&
      kind.metric() != v1::DESCRIPTOR_METRIC_L2_U8) {
    return convert::UnknownEnum(field + ".metric", kind.metric());
  }
  // DescriptorMetric has the wire's numbers.
  return DescriptorKind{kind.name(), kind.bytes_count(),
                        static_cast<DescriptorMetric>(kind.metric())};
}

void DescriptorKindToProto(const DescriptorKind& kind, v1::DescriptorKind* proto) {
  proto->Clear();
  if (kind.name.empty()) return;
  proto->set_name(kind.name);
  proto->set_bytes_count(kind.bytes);
  proto->set_metric(static_cast<v1::DescriptorMetric>(kind.metric));
}

}  // namespace maploc
