// SPDX-License-Identifier: MIT
#include "server/show/bake/bake_progress.hpp"

#include <gtest/gtest.h>

namespace hapticast::server {
namespace {

TEST(BakeProgressTest, DescribesShareRateAndRemainingTime) {
  EXPECT_EQ(describeProgress("bakes", 50, 200, 2.0), "bakes: 25 %, 25.0 frames/s, 0:06 left");
  EXPECT_EQ(describeProgress("bakes", 10, 1510, 10.0), "bakes: 1 %, 1.0 frames/s, 25:00 left");
  EXPECT_EQ(describeProgress("bakes", 210, 200, 2.0), "bakes: 100 %, 105.0 frames/s, 0:00 left");
}

TEST(BakeProgressTest, ClipsOfUnknownLengthHaveTheirRate) {
  EXPECT_EQ(describeProgress("bakes", 50, 0, 2.0), "bakes: 50 frames, 25.0 frames/s");
  EXPECT_EQ(describeProgress("bakes", 0, 10, 0.0), "bakes: 0 frames, 0.0 frames/s");
}

}  // namespace
}  // namespace hapticast::server
