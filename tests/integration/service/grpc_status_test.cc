#include "server/service/grpc_status.h"

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(RetryDelayTest, EveryRefusalThatPassesHasATime) {
  for (const char* reason :
       {"STORE_BUSY", "STATISTICS_BACKLOG", "SHUTTING_DOWN", "MAP_MOVES", "STORE_NOT_WRITABLE"}) {
    EXPECT_GT(RetryDelayMs(Status(StatusCode::kUnavailable, reason, "")).value_or(0), 0) << reason;
  }
  for (const char* reason : {"QUEUE_FULL", "TOO_MANY_SESSIONS", "DISK_FULL"}) {
    EXPECT_GT(RetryDelayMs(ResourceExhausted(reason, "")).value_or(0), 0) << reason;
  }
}

TEST(RetryDelayTest, WhatNeverPassesHasNone) {
  EXPECT_EQ(RetryDelayMs(ResourceExhausted("TOO_MANY_FEATURES", "")), std::nullopt);
  EXPECT_EQ(RetryDelayMs(InvalidArgument("map", "is required", "REQUIRED")), std::nullopt);
}

}  // namespace
}  // namespace maploc
