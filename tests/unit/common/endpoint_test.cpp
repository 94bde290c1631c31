// SPDX-License-Identifier: MIT
#include "common/endpoint.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace hapticast {
namespace {

TEST(Endpoint, IsReadBackAsItIsWritten) {
  for (const Endpoint& each : {Endpoint{"localhost", 7447}, {"10.0.0.7", 0}, {"fe80::2", 65535}}) {
    const auto back = parseEndpoint(toString(each), {"x", 1});
    ASSERT_TRUE(back) << toString(each);
    EXPECT_EQ(*back, each);
  }
  EXPECT_EQ(toString({"::1", 90}), "[::1]:90");
}

TEST(Endpoint, TakesEveryFormAndTheRestFromElsewhere) {
  const Endpoint otherwise{"here", 7447};
  const std::vector<std::pair<const char*, Endpoint>> forms = {
      {"localhost", {"localhost", 7447}},
      {"localhost:7500", {"localhost", 7500}},
      {"10.0.0.7", {"10.0.0.7", 7447}},
      {"10.0.0.7:81", {"10.0.0.7", 81}},
      {":7500", {"here", 7500}},
      {"7500", {"here", 7500}},
      {"[::1]", {"::1", 7447}},
      {"[fe80::2]:7000", {"fe80::2", 7000}},
      {"::1", {"::1", 7447}},
      {"fe80::2%eth0", {"fe80::2%eth0", 7447}},
      {"::", {"::", 7447}},
      {"host:0", {"host", 0}},
  };
  for (const auto& [text, endpoint] : forms) EXPECT_EQ(parseEndpoint(text, otherwise), endpoint);
}

TEST(Endpoint, RefusesTheRest) {
  for (const char* text : {"", ":", "host:", "host:65536", "65536", ":65536", "host:-1", "host:8x",
                           "a b", "[::1", "[::1]x", "[]:80", "a/b", "a:b:c", "http://x:80"}) {
    EXPECT_FALSE(parseEndpoint(text, {"here", 1})) << text;
  }
}

}  // namespace
}  // namespace hapticast
