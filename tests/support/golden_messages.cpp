// SPDX-License-Identifier: MIT
#include "tests/support/golden_messages.hpp"

#include <numeric>

#include "tests/support/coded.hpp"

namespace hapticast::testing {

namespace {

std::shared_ptr<const Relief> relief() {
  auto relief = std::make_shared<Relief>();
  relief->rect = {100, 50, 10, 3};  // rows of 10 bits: padding is used
  relief->mask.assign(30, 0);
  relief->height_mm.assign(30, 0.0F);
  for (std::size_t i = 3; i < 27; i += 2) {
    relief->mask[i] = 1;
    relief->height_mm[i] = 4.0F + 0.5F * static_cast<float>(i);
  }
  return relief;
}

std::shared_ptr<const MotionGrid> grid() {
  auto grid = std::make_shared<MotionGrid>();
  grid->columns = 1;
  grid->rows = 1;
  grid->velocity_mm_s = {{1.0F, -2.0F, 3.0F}};
  grid->acceleration_mm_s2 = {{-10.0F, 20.0F, -30.0F}};
  return grid;
}

}  // namespace

StreamDescription goldenDescription() {
  StreamDescription description;
  description.name = "synthetic:bounce";
  description.fps = 25.0;
  description.workspace = {640, 480, 160.0, 120.0, 30.0, true};
  description.method = Method::kThesis;
  description.pipeline_latency = std::chrono::milliseconds(120);
  description.largest_acceleration_mm_s2 = 2500.0;
  description.mass_kg = 0.5;
  return description;
}

HapticFrame goldenFrame() {
  HapticFrame frame;
  frame.epoch = 3;
  frame.id = 1000;
  frame.media_time = mediaTime(40.04);
  HapticObject ball;
  ball.id = 7;
  ball.layer = 1;
  ball.changed_in_frame = 1000;
  ball.relief = relief();
  ball.motion = {{1.5, -2.5, 12.0},
                 {100.0, -50.0, 25.0},
                 {-900.0, 450.0, 0.0},
                 0.25,
                 -0.5,
                 ReferencePoint::kCentreOfMass,
                 0.75,
                 0.5};
  ball.grid = grid();
  ball.impacts = {{mediaTime(40.0), {0.0, 200.0, -1.0}}, {mediaTime(40.08), {0.0, 150.0, 0.0}}};
  ball.material = {0.5, 1.0, 0.25, 0.0, {}, {}};  // no sliding friction, and of K nothing is said
  frame.objects.push_back(ball);
  HapticObject still;
  still.id = 8;
  still.changed_in_frame = 990;
  still.motion.reference_point = ReferencePoint::kVisibleCentroid;
  frame.objects.push_back(still);
  return frame;
}

DatagramKey goldenKey() {
  DatagramKey key{7, {}, std::chrono::seconds(10)};
  for (std::size_t i = 0; i < key.bytes.size(); ++i) key.bytes[i] = static_cast<std::uint8_t>(i);
  return key;
}

SigningKey goldenSigningKey() {
  KeyBytes seed{};
  std::iota(seed.begin(), seed.end(), std::uint8_t{0});
  return SigningKey(seed);
}

Welcome goldenWelcome() {
  Welcome welcome{kProtocolVersion, 42, 0x0123456789ABCDEF, goldenDescription()};
  welcome.datagram_port = 7448;
  welcome.stream = 0x89ABCDEF;
  welcome.verifying_key.emplace().fill(0x5A);
  welcome.group = DatagramGroup{"239.1.2.3", 7449, 0xFEDCBA9876543210};
  return welcome;
}

std::vector<std::pair<std::string, Message>> goldenMessages() {
  Welcome sealed = goldenWelcome();
  sealed.datagram_key = goldenKey();
  return {
      {"hello", Hello{kProtocolVersion, "viewer-1", true, true}},
      {"welcome", goldenWelcome()},
      {"welcome_with_key", sealed},
      {"ping", Ping{localTime(1.25)}},
      {"pong", Pong{localTime(1.25), mediaTime(2.5), mediaTime(2.500001)}},
      {"pong_of_an_edge",
       Pong{localTime(1.25), mediaTime(2.5), mediaTime(2.500001), fromSeconds(0.0025)}},
      {"description", goldenDescription()},
      {"frame", coded(goldenFrame())},
      {"video", VideoFrame{3, 1000, mediaTime(40.04), {0xFF, 0xD8, 0xFF, 0xE0, 0xFF, 0xD9}}},
      {"report", ReceiverReport{1000, 3, 2, 52.5, 125.0, true}},
      {"preparing", Preparing{0.5}},
      {"delivery", Delivery{false, true, 2}},
      {"delivery_without_pictures", Delivery{true, true, 1, false}},
      {"hello_with_parts", Hello{kProtocolVersion, "viewer-1", true, true, "", true}},
      {"picture_part", PicturePart{300, {0x3A, 0x09, 0xFF, 0xD8}, true}},
      {"receipt", Receipt{123456, std::chrono::microseconds(750)}},
      {"hello_with_token", Hello{kProtocolVersion, "viewer-1", false, false, "s3cret"}},
      {"datagram_key", goldenKey()},
      {"control", Control{true, 12.5, {0.5, {}, {}, {}, {}, 0.25}}},
      {"control_with_viewers", Control{false, {}, {}, {}, 300U}},
      {"control_of_another_operator", Control{false, {}, {}, {}, {}, "Anna", mediaTime(40.04)}},
      {"error", WireError{ErrorCode::kServerFull, "all 64 places are taken"}},
  };
}

}  // namespace hapticast::testing
