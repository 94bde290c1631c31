// SPDX-License-Identifier: MIT
#include "common/endpoint.hpp"

#include <gtest/gtest.h>

namespace hapticast {
namespace {

TEST(Endpoint, IsReadBackAsItIsWritten) {
  for (const Endpoint& each : {Endpoint{"localhost", 7447}, {"10.0.0.7", 0}, {"fe80::2", 65535}}) {
    const auto back = parseEndpoint(toString(each));
    ASSERT_TRUE(back) << toString(each);
    EXPECT_EQ(*back, each);
  }
  EXPECT_EQ(toString({"::1", 90}), "[::1]:90");
}

}  // namespace
}  // namespace hapticast
