// SPDX-License-Identifier: MIT
#include "common/mdns.hpp"

#include <gtest/gtest.h>

namespace hapticast {
namespace {

TEST(Service, TextsOfTheNetworkAreCleaned) {
  EXPECT_EQ(sanitizeUtf8("Living room", 63), "Living room");
  EXPECT_EQ(sanitizeUtf8("Küche \xF0\x9F\x8F\x80 漢", 63), "Küche \xF0\x9F\x8F\x80 漢");
  EXPECT_EQ(sanitizeUtf8("\x1b[2J\r\n\x7f", 63), "?[2J???") << "escapes of a terminal";
  EXPECT_EQ(sanitizeUtf8("a\xC2\x9B"
                         "31m",
                         63),
            "a?31m")
      << "the same in one character";
  EXPECT_EQ(sanitizeUtf8("a\xE2\x80\xAE"
                         "b\xE2\x81\xA6\xE2\x80\xA8",
                         63),
            "a?b??")
      << "turns what follows round";
  EXPECT_EQ(sanitizeUtf8("a\xFF\xC0\x80\xED\xA0\x80\xF4\x90\x80\x80", 63), "a??????????")
      << "no UTF-8: a wild byte, an overlong zero, half a surrogate, beyond the last code";
  EXPECT_EQ(sanitizeUtf8("\xE6\xBC", 63), "??") << "cut off";
  EXPECT_EQ(sanitizeUtf8("漢漢", 5), "漢") << "between two characters";
  EXPECT_EQ(sanitizeUtf8(std::string_view("a\0b", 3), 63), "a?b");
  EXPECT_EQ(sanitizeUtf8("", 63), "");
}

TEST(Service, Names) {
  EXPECT_TRUE(isServiceName("a"));
  EXPECT_TRUE(isServiceName("Küche \xF0\x9F\x8F\x80"));
  EXPECT_TRUE(isServiceName(std::string(63, 'x')));
  EXPECT_FALSE(isServiceName(""));
  EXPECT_FALSE(isServiceName(std::string(64, 'x')));
  EXPECT_FALSE(isServiceName("two\nlines"));
  EXPECT_FALSE(isServiceName("\x1b[31mred"));
  EXPECT_FALSE(isServiceName("a\xFF"));
}

}  // namespace
}  // namespace hapticast
