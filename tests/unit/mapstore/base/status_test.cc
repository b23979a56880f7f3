#include "mapstore/base/status.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace maploc {
namespace {

Status Fails() { return InvalidArgument("views[0].camera", "has no focal length"); }
Result<int> GivesOrFails(bool fail) {
  if (fail) return Fails();
  return 7;
}
Result<int> AddsOne(bool fail) {
  MAPLOC_ASSIGN_OR_RETURN(const int value, GivesOrFails(fail));
  return value + 1;
}
Status OnlyStatus(bool fail) {
  MAPLOC_RETURN_IF_ERROR(AddsOne(fail).status());
  return Status::Ok();
}

TEST(StatusTest, SaysCodeReasonAndFieldOnOneLine) {
  EXPECT_EQ(Fails().ToString(),
            "INVALID_ARGUMENT (INVALID_FIELD): views[0].camera: has no focal length");
  EXPECT_EQ(Status::Ok().ToString(), "OK");
}

TEST(StatusTest, ContextKeepsCodeAndReason) {
  const Status seen_from_outside = NotFound("map 'yard'").WithContext("localize");
  EXPECT_EQ(seen_from_outside.code(), StatusCode::kNotFound);
  EXPECT_EQ(seen_from_outside.reason(), "NOT_FOUND");
  EXPECT_EQ(seen_from_outside.message(), "localize: map 'yard' does not exist");
  EXPECT_TRUE(Status::Ok().WithContext("anything").ok());
}

TEST(StatusTest, EveryCodeHasANameOfItsOwn) {
  for (int code = 0; code <= 16; ++code) {
    if (code == 2 || code == 11) continue;  // UNKNOWN and OUT_OF_RANGE: nobody returns them
    EXPECT_NE(StatusCodeName(static_cast<StatusCode>(code)), "UNKNOWN") << code;
  }
}

TEST(ResultTest, MacrosPassTheFirstFailureOn) {
  EXPECT_EQ(AddsOne(false).value(), 8);
  EXPECT_EQ(AddsOne(true).status().ToString(), Fails().ToString());
  EXPECT_TRUE(OnlyStatus(false).ok());
  EXPECT_EQ(OnlyStatus(true).code(), StatusCode::kInvalidArgument);
}

TEST(ResultTest, HoldsWhatCannotBeCopied) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(3));
  const std::unique_ptr<int> taken = std::move(result).value();
  EXPECT_EQ(*taken, 3);
}

}  // namespace
}  // namespace maploc
