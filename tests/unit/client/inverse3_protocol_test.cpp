// SPDX-License-Identifier: MIT
#include "client/device/inverse3/protocol.hpp"

#include <gtest/gtest.h>

#include <random>

namespace hapticast::client {
namespace {

TEST(Inverse3Protocol, ReadsAStateIntoTheDeviceFrame) {
  const auto message = parseInverse3(
      R"({"session_id":7,"inverse3":[{"device_id":"049D","config":{"type":"minverse",
          "filters":{"force_gate":{"gain":0},"damping":{"scalar":0.2}}},
          "state":{"cursor_position":{"x":0.01,"y":0.02,"z":0.03}},"status":{"calibrated":false}}],
          "verse_grip":[],"wireless_verse_grip":[{"state":{"buttons":{"a":true,"b":false,"c":true}}}]})");
  ASSERT_TRUE(message);
  ASSERT_EQ(message->devices.size(), 1U);
  const Inverse3Device& device = message->devices.front();
  EXPECT_EQ(device.id, "049D");
  EXPECT_EQ(device.type, "minverse");
  EXPECT_TRUE(device.position_mm->isApprox(Vec3(10.0, 30.0, -20.0)));
  EXPECT_FALSE(device.calibrated);
  EXPECT_TRUE(device.filtered);
  EXPECT_EQ(message->buttons, 5U);
  EXPECT_EQ(selectForceKey(*message), Inverse3ForceKey::kVector);
}

TEST(Inverse3Protocol, TheKeyOfTheForceFollowsTheVersion) {
  const auto key = [](const char* text) { return selectForceKey(*parseInverse3(text)); };
  EXPECT_EQ(key(R"({"version":"3.4.9"})"), Inverse3ForceKey::kValues);
  EXPECT_EQ(key(R"({"version":"3.5.0"})"), Inverse3ForceKey::kVector);
  EXPECT_EQ(key(R"({"version":"3.12.0"})"), Inverse3ForceKey::kVector);
  EXPECT_EQ(key(R"({"version":"4.0.0"})"), Inverse3ForceKey::kVector);
  EXPECT_EQ(key("{}"), Inverse3ForceKey::kValues) << "services before 3.5 name no session";
}

TEST(Inverse3Protocol, AForceIsTurnedIntoTheServicesFrame) {
  EXPECT_EQ(
      toForceMessage("D", Inverse3ForceKey::kVector, {1.0, 2.0, 3.0}),
      R"({"inverse3":[{"commands":{"set_cursor_force":{"vector":{"x":1.0,"y":-3.0,"z":2.0}}},)"
      R"("device_id":"D"}]})");
  EXPECT_NE(toForceMessage("D", Inverse3ForceKey::kValues, {}).find("\"values\""),
            std::string::npos);
  EXPECT_NE(toSessionMessage("D", "p").find("org.hapticast:viewer"), std::string::npos);
}

TEST(Inverse3Protocol, IgnoresFieldsOfAnotherForm) {
  EXPECT_FALSE(parseInverse3("[1]"));
  EXPECT_FALSE(parseInverse3("{"));
  EXPECT_FALSE(parseInverse3(""));
  for (const char* text :
       {R"({"inverse3":7})", R"({"inverse3":{"device_id":1}})", R"({"inverse3":[7,"x",null]})",
        R"({"inverse3":[{"state":{"cursor_position":{"x":"1","y":null}}}]})",
        R"({"wireless_verse_grip":[[]],"verse_grip":7,"version":3})"}) {
    const auto message = parseInverse3(text);
    ASSERT_TRUE(message) << text;
    for (const Inverse3Device& device : message->devices) EXPECT_FALSE(device.position_mm) << text;
  }
  EXPECT_LE(parseInverse3("{\"inverse3\":[" + std::string(9998, '0').replace(1, 0, ",") + "0]}")
                .value_or(Inverse3Message{})
                .devices.size(),
            16U);
}

TEST(Inverse3Protocol, FlippedBytesNeverThrow) {
  std::mt19937 random(32);
  const std::string good =
      R"({"session_id":7,"inverse3":[{"device_id":"1","state":{"cursor_position":{"x":0,"y":1,"z":2}}}]})";
  for (int i = 0; i < 20'000; ++i) {
    std::string text = good;
    for (unsigned n = 0; n <= random() % 4; ++n)
      text[random() % text.size()] = static_cast<char>(random() % 256);
    EXPECT_NO_THROW((void)parseInverse3(text));
  }
}

}  // namespace
}  // namespace hapticast::client
