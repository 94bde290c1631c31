// SPDX-License-Identifier: MIT
#include "common/protocol/wire_reader.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

namespace hapticast {
namespace {

std::span<const std::uint8_t> asBytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(WireReader, ReadsWhatTheWriterWrites) {
  std::mt19937_64 random(52);
  for (int i = 0; i < 500; ++i) {
    const std::uint64_t number = random() >> (random() % 64);
    const double fixed = std::uniform_real_distribution(-1e9, 1e9)(random);
    const std::string text(random() % 300, 'x');
    WireWriter out;
    out.tag(7, WireType::kVarint);
    out.varint(number);
    out.fixed(fixed);
    out.bytes(text);
    WireReader in(asBytes(out.result()));
    std::uint32_t tag = 0;
    std::uint64_t read = 0;
    double value = 0.0;
    std::span<const std::uint8_t> bytes;
    ASSERT_TRUE(in.readTag(tag) && in.readVarint(read) && in.readFixed(value) &&
                in.readBytes(bytes));
    EXPECT_EQ(numberOf(tag), 7U);
    EXPECT_EQ(typeOf(tag), WireType::kVarint);
    EXPECT_EQ(read, number);
    EXPECT_EQ(value, fixed);
    EXPECT_EQ(bytes.size(), text.size());
    EXPECT_TRUE(in.atEnd());
  }
}

TEST(WireReader, RefusesWhatLeavesItsBytes) {
  std::uint64_t number = 0;
  std::uint32_t tag = 0;
  std::span<const std::uint8_t> bytes;
  EXPECT_FALSE(WireReader(asBytes("\x80")).readVarint(number));
  EXPECT_FALSE(WireReader(asBytes(std::string(11, '\x80'))).readVarint(number));
  EXPECT_FALSE(WireReader(asBytes("\x02\x01")).readTag(tag)) << "the number 0";
  EXPECT_FALSE(WireReader(asBytes(std::string("\x80\x80\x80\x80\x80\x01", 6))).readTag(tag));
  EXPECT_FALSE(WireReader(asBytes("\x05"
                                  "abc"))
                   .readBytes(bytes));
  double fixed = 0.0;
  EXPECT_FALSE(WireReader(asBytes("1234567")).readFixed(fixed));
}

TEST(WireReader, SkipsFieldsOfEachKind) {
  WireWriter out;
  out.tag(1, WireType::kBeginGroup);
  out.tag(2, WireType::kFixed32);
  out.fixed(1.0F);
  out.tag(3, WireType::kBytes);
  out.bytes("abc");
  out.tag(1, WireType::kEndGroup);
  WireReader in(asBytes(out.result()));
  std::uint32_t tag = 0;
  ASSERT_TRUE(in.readTag(tag));
  EXPECT_TRUE(in.skip(tag));
  EXPECT_TRUE(in.atEnd());
}

TEST(WireReader, RefusesDeepGroups) {
  const auto nest = [](int depth) {
    WireWriter out;
    for (int i = 0; i < depth; ++i) out.tag(1, WireType::kBeginGroup);
    for (int i = 0; i < depth; ++i) out.tag(1, WireType::kEndGroup);
    const std::string bytes = out.result();
    WireReader in(asBytes(bytes));
    std::uint32_t tag = 0;
    return in.readTag(tag) && in.skip(tag);
  };
  EXPECT_TRUE(nest(WireReader::kMostDepth));
  EXPECT_FALSE(nest(WireReader::kMostDepth + 1));
  EXPECT_FALSE(nest(100'000));
}

TEST(WireReader, KnowsUtf8) {
  for (const char* const text : {"", "abc", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x91\x8B"})
    EXPECT_TRUE(isUtf8(text)) << text;
  for (const char* const text : {"\x80", "\xC0\x80", "\xC3", "\xE0\x80\x80", "\xED\xA0\x80",
                                 "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80"})
    EXPECT_FALSE(isUtf8(text)) << text;
}

}  // namespace
}  // namespace hapticast
