// SPDX-License-Identifier: MIT
// A clip's files by themselves: their order, and what meta.json may say.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/source/folder/clip_meta.hpp"
#include "server/source/folder/image_lists.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {
namespace {

TEST(ClipFiles, NaturalOrder) {
  EXPECT_TRUE(precedesNaturally("frame2.png", "frame10.png"));
  EXPECT_FALSE(precedesNaturally("frame10.png", "frame2.png"));
  EXPECT_TRUE(precedesNaturally("000009.png", "000010.png"));
  EXPECT_TRUE(precedesNaturally("1.png", "01.png") != precedesNaturally("01.png", "1.png"));
  EXPECT_TRUE(precedesNaturally("1305031102.175.png", "1305031102.211.png"));
  EXPECT_TRUE(precedesNaturally("99999999999999999999998", "99999999999999999999999"));
  EXPECT_FALSE(precedesNaturally("a", "a"));
}

TEST(ClipMetaJson, IsReadAndRefused) {
  const ClipMeta meta = parseClipMeta(
      R"( {"fps": 2.5e1, "depth": "a \"16-bit\"\n", "e": true, "c": [1, {"fps": 0}]} )",
      "meta.json");
  EXPECT_EQ(meta.fps, 25.0);
  EXPECT_EQ(meta.depth_bits, 16);
  EXPECT_FALSE(meta.mm_per_unit);
  EXPECT_FALSE(meta.camera);
  EXPECT_EQ(parseClipMeta(R"({"fps": "30", "depth": null})", "").fps, 30.0);
  EXPECT_EQ(parseClipMeta(R"({"depth_bits": 8, "depth": "16-bit"})", "").depth_bits, 8);
  EXPECT_EQ(parseClipMeta(R"({"depth_scale_m_per_unit": 0.001})", "").depth_bits, 16);
  const std::string deep =
      fmt::format("{{\"a\": {}{}}}", std::string(32, '['), std::string(32, ']'));
  const std::string large = fmt::format("{{\"a\": \"{}\"}}", std::string(kMaxMeta_bytes, 'x'));
  for (const std::string& bad :
       std::vector<std::string>{"", "[]", "null", "{", "{}}", "{\"a\"}", "{\"a\": }", "{\"a\": 1,}",
                                "{\"a", "{\"a\": \"\\u12", "{\"a\": \"\xff\"}", "{\"a\": 1e999}",
                                "{\"a\": 1, \"a\": 1}", deep, large}) {
    EXPECT_THROW((void)parseClipMeta(bad, "meta.json"), SourceError) << bad.substr(0, 60);
  }
  EXPECT_THROW((void)parseClipMeta(R"({"fps": [25]})", ""), SourceError);
  EXPECT_THROW((void)parseClipMeta(R"({"fps": "\ud800"})", ""), SourceError);
}

}  // namespace
}  // namespace hapticast::server
