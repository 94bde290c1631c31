// SPDX-License-Identifier: MIT
#include "common/json/json_document.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace hapticast {
namespace {

const char* const kText = R"({
  "rate": "25",
  "kind": "fast",
  "sides": [{"width": 640},
            {"width": -1, "widht": 2}],
  "matrix": [1, 2, "3"],
  "none": null
})";

/// Returns "LINE:COLUMN: WHAT" of the error that `read` throws.
std::string refusal(const std::function<void()>& read) {
  try {
    read();
    return "accepted";
  } catch (const JsonError& error) {
    return describe("f", error).substr(2);
  }
}

std::string parsing(const std::string& text, const JsonLimits& limits = {}) {
  return refusal([&] { (void)parseJson(text, limits); });
}

TEST(JsonDocument, ReadsMembersWithinTheirRanges) {
  const JsonDocument document = parseJson(kText);
  JsonObject object(document);
  EXPECT_EQ(object.number("rate", 1.0, 240.0), 25.0) << "a text that is a number";
  EXPECT_EQ(object.text("kind", 4), "fast");
  EXPECT_EQ(object.number("absent", 0.0, 1.0), std::nullopt);
  EXPECT_EQ(object.number("none", 0.0, 1.0), std::nullopt) << "null counts as missing";
  EXPECT_EQ(object.choice<int>("kind", {{"fast", 1}, {"slow", 2}}), 1);
  auto sides = object.objects("sides", 2);
  ASSERT_EQ(sides.size(), 2U);
  EXPECT_EQ(sides[0].count("width", 1, 1000), 640U);
  EXPECT_EQ(sides[1].place(), (JsonPlace{5, 13}));
}

TEST(JsonDocument, NamesThePlaceOfAWrongMember) {
  const JsonDocument document = parseJson(kText);
  JsonObject object(document);
  EXPECT_EQ(refusal([&] { (void)object.number("rate", 30.0, 240.0); }),
            "2:3: 'rate' is no number from 30 to 240");
  EXPECT_EQ(refusal([&] { (void)object.text("kind", 3); }),
            "3:3: 'kind' is no text of 1 to 3 bytes");
  EXPECT_EQ(refusal([&] {
              (void)object.choice<int>("kind", {{"fastest", 1}, {"slow", 2}});
            }),
            "3:3: 'kind' is none of fastest, slow");
  EXPECT_EQ(refusal([&] { (void)object.objects("sides", 1); }),
            "4:3: 'sides' is no list with at most 1 members");
  JsonObject side = object.objects("sides", 2)[1];
  EXPECT_EQ(refusal([&] { (void)side.number("width", 0.0, 1.0); }),
            "5:14: 'width' is no number from 0 to 1");
  EXPECT_EQ(refusal([&] { side.refuseOthers("is unknown"); }),
            "5:27: 'widht' is unknown; did you mean width?");
  EXPECT_EQ(refusal([&] { (void)object.numbers("matrix", 3, 0.0, 9.0); }),
            "6:3: 'matrix' is no list of 3 numbers from 0 to 9");
  EXPECT_EQ(refusal([&] { (void)object.numbers("absent", 3, 0.0, 9.0); }),
            "1:1: 'absent' is missing; expected are 3 numbers from 0 to 9");
  EXPECT_EQ(refusal([&] { (void)object.object("rate"); }), "2:3: 'rate' is no JSON object {...}");
}

TEST(JsonDocument, RefusesOtherTextsAndThoseBeyondALimit) {
  EXPECT_EQ(parsing(""), "1:1: is no JSON from here on");
  EXPECT_EQ(parsing("[1]"), "1:1: is no JSON object");
  EXPECT_EQ(parsing("{\n  \"a\": 1,\n  \"a\": 2}"), "3:3: 'a' appears twice");
  EXPECT_EQ(parsing("{\"a\": 1e999}"), "1:13: has a number that is too large");
  EXPECT_EQ(parsing("{\"a\":\n [[1]]}", {.most_levels = 2}), "2:4: has more than 2 levels");
  EXPECT_EQ(parsing("{\"a\": 1}", {.most_bytes = 7}), "1:1: has more than 7 bytes");
  EXPECT_EQ(parsing(R"({"a/b": 1, "a": {"b": 2}})"), "accepted");
  std::string members = "{\"" + std::string(1U << 20U, 'x') + "\": {\"a\": 0";
  for (int i = 0; i < 100; ++i) members += ", \"" + std::to_string(i) + "\": 0";
  EXPECT_NE(parsing(members + "}}", {.most_bytes = 2U << 20U}).find("too long names"),
            std::string::npos);
  EXPECT_EQ(parsing("{\"a\": 1} x").substr(0, 2), "1:");
}

}  // namespace
}  // namespace hapticast
