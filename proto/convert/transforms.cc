// Rigid and similarity transforms.
#include <cmath>

#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc {

Result<Rigid3> Rigid3FromProto(const v1::Rigid3& rigid, const std::string& field) {
  Rigid3 result;
  // proto3 reads an unset message as zeros, and a forgotten translation would be taken for none. A
  // rotation needs no such check: zeros are no unit quaternion.
  if (!rigid.has_translation()) {
    return InvalidArgument(field + ".translation", "is required; send zeros where it is zero",
                           "REQUIRED");
  }
  MAPLOC_ASSIGN_OR_RETURN(result.rotation,
                          convert::QuaternionFromProto(rigid.rotation(), field + ".rotation"));
  MAPLOC_ASSIGN_OR_RETURN(result.translation,
                          convert::VectorFromProto(rigid.translation(), field + ".translation"));
  return result;
}

void Rigid3ToProto(const Rigid3& rigid, v1::Rigid3* proto) {
  convert::QuaternionToProto(rigid.rotation, proto->mutable_rotation());
  convert::VectorToProto(rigid.translation, proto->mutable_translation());
}

Result<Similarity3> Similarity3FromProto(const v1::Similarity3& similarity,
                                         const std::string& field) {
  Similarity3 result;
  result.scale = similarity.scale();
  if (!std::isfinite(result.scale) || !(result.scale > 0)) {
    return InvalidArgument(field + ".scale", "must be positive", "OUT_OF_RANGE");
  }
  MAPLOC_ASSIGN_OR_RETURN(result.rotation,
                          convert::QuaternionFromProto(similarity.rotation(), field + ".rotation"));
  MAPLOC_ASSIGN_OR_RETURN(result.translation, convert::VectorFromProto(similarity.translation(),
                                                                       field + ".translation"));
  return result;
}

void Similarity3ToProto(const Similarity3& similarity, v1::Similarity3* proto) {
  proto->set_scale(similarity.scale);
  convert::QuaternionToProto(similarity.rotation, proto->mutable_rotation());
  convert::VectorToProto(similarity.translation, proto->mutable_translation());
}

}  // namespace maploc
