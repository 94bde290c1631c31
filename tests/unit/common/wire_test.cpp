// SPDX-License-Identifier: MIT
// Golden bytes: HAPTICAST_UPDATE_GOLDEN=1 unit_common --gtest_filter='WireGolden.*' writes
// golden/*.hex and the fuzzers' seeds anew; look at the difference before you commit it, and bump
// kProtocolVersion if it is one.
#include "common/protocol/messages.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/transport/framing.hpp"
#include "common/wire_limits.hpp"
#include "tests/support/framed.hpp"
#include "tests/support/golden_bytes.hpp"
#include "tests/support/golden_messages.hpp"
#include "tests/unit/common/wire_messages.hpp"

namespace hapticast {
namespace {

using testing::goldenDescription;
using testing::goldenFrame;
using testing::goldenMessages;
using testing::randomRelief;
using testing::roundTrip;
using Bytes = std::vector<std::uint8_t>;

TEST(WireGolden, BytesOfEveryKindStayAsTheyAre) {
  const std::filesystem::path corpus = testing::testsFolder() / "fuzz/corpus";
  for (const auto& [name, message] : goldenMessages()) {
    const Bytes bytes = encode(message);
    testing::expectGolden(name, bytes);
    if (!testing::updatesGolden()) continue;
    testing::writeBytes(corpus / "wire" / name, bytes);
    testing::writeBytes(corpus / "framing" / name, testing::framed(bytes));
  }
}

TEST(WireGolden, DecodeToTheSameMessage) {
  for (const auto& [name, message] : goldenMessages()) {
    const Bytes bytes = testing::readGolden(name);
    const auto decoded = decode(bytes);
    ASSERT_TRUE(decoded.ok()) << name << ": " << decoded.error().message;
    EXPECT_EQ(decoded.value().index(), message.index()) << name;
    EXPECT_EQ(encode(decoded.value()), bytes) << name;
  }
}

TEST(Wire, CarriesHelloWelcomePingPong) {
  const auto hello = roundTrip(Hello{5, "ann", true, false});
  EXPECT_EQ(hello.protocol_version, 5U);
  EXPECT_EQ(hello.client_name, "ann");
  EXPECT_TRUE(hello.wants_video);
  EXPECT_FALSE(hello.wants_frames_on_tcp);
  const auto plain = roundTrip(Welcome{1, 9, 0, goldenDescription()});
  EXPECT_EQ(plain.session_id, 9U);
  EXPECT_EQ(plain.datagram_token, 0U);
  EXPECT_EQ(plain.verifying_key, std::nullopt);
  EXPECT_EQ(plain.group, std::nullopt);
  const Welcome sent = testing::goldenWelcome();
  const auto welcome = roundTrip(sent);
  EXPECT_EQ(welcome.datagram_token, sent.datagram_token);
  EXPECT_EQ(welcome.description, goldenDescription());
  EXPECT_EQ(welcome.datagram_port, 7448);
  EXPECT_EQ(welcome.stream, sent.stream);
  EXPECT_EQ(welcome.verifying_key, sent.verifying_key);
  EXPECT_EQ(welcome.group, sent.group);
  Welcome sealed = sent;
  sealed.datagram_key = testing::goldenKey();
  EXPECT_EQ(roundTrip(sealed).datagram_key, sealed.datagram_key);
  EXPECT_EQ(roundTrip(testing::goldenKey()), testing::goldenKey());
  EXPECT_EQ(roundTrip(Hello{kProtocolVersion, "x", false, true, "s3\xFF"}).access_token, "s3\xFF");
  EXPECT_TRUE(roundTrip(Hello{kProtocolVersion, "x", false, true, "", false, true}).wants_acts);
  for (const Control& control :
       {Control{}, Control{false, {}, {}}, Control{{}, 0.0, {}},
        Control{true, 2.5, {0.5, 1.0, 0.25, 0.25, 30.0, 2.0}}, Control{{}, {}, {}, 0.5, 0U},
        Control{{}, {}, {}, {}, 2000U}, Control{false, {}, {}, {}, {}, "Änna", mediaTime(-2.5)}})
    EXPECT_EQ(roundTrip(control), control);
  const auto delivery = roundTrip(Delivery{false, true, 4});
  EXPECT_FALSE(delivery.on_tcp);
  EXPECT_TRUE(delivery.datagrams);
  EXPECT_EQ(delivery.copies, 4U);
  EXPECT_EQ(roundTrip(Ping{localTime(-1.5)}).t0, localTime(-1.5));
  const auto pong = roundTrip(Pong{localTime(1), mediaTime(2), mediaTime(3)});
  EXPECT_EQ(pong.t0, localTime(1));
  EXPECT_EQ(pong.t1, mediaTime(2));
  EXPECT_EQ(pong.t2, mediaTime(3));
  EXPECT_EQ(pong.error, Duration::zero());
  const auto largest = roundTrip(Pong{{}, {}, {}, Duration(limits::kClockError_ns)});
  EXPECT_EQ(largest.error, Duration(limits::kClockError_ns));
  for (const Duration wrong : {Duration(-1), Duration(limits::kClockError_ns + 1)})
    EXPECT_FALSE(decode(encode(Pong{{}, {}, {}, wrong})).ok());
}

TEST(Wire, CarriesDescriptionsReportsVideoAndErrors) {
  EXPECT_EQ(roundTrip(goldenDescription()), goldenDescription());
  StreamDescription plain;
  EXPECT_EQ(roundTrip(plain), plain) << "no mass stays no mass";
  const auto report = roundTrip(ReceiverReport{1, 2, 3, 4.5, 5.5, true});
  EXPECT_EQ(report.frames_received, 1U);
  EXPECT_EQ(report.frames_lost, 2U);
  EXPECT_EQ(report.frames_late, 3U);
  EXPECT_DOUBLE_EQ(report.playout_delay_ms, 4.5);
  EXPECT_DOUBLE_EQ(report.clock_error_us, 5.5);
  EXPECT_TRUE(report.in_contact);
  const auto video = roundTrip(VideoFrame{1, 2, mediaTime(3), {0xFF, 0xD8, 0x00}});
  EXPECT_EQ(video.id, 2U);
  EXPECT_EQ(video.media_time, mediaTime(3));
  EXPECT_EQ(video.jpeg, (Bytes{0xFF, 0xD8, 0x00}));
  for (int code = 1; code <= 7; ++code) {
    EXPECT_EQ(roundTrip(WireError{static_cast<ErrorCode>(code), "x"}).code,
              static_cast<ErrorCode>(code));
  }
}

TEST(Wire, CarriesEveryFieldOfAFrame) {
  const HapticFrame sent = goldenFrame();
  const CodedFrame got = roundTrip(sent);
  EXPECT_EQ(got.epoch, 3U);
  EXPECT_EQ(got.id, 1000U);
  EXPECT_EQ(got.media_time, sent.media_time);
  ASSERT_EQ(got.objects.size(), 2U);
  const CodedObject& ball = got.objects[0];
  const HapticObject& from = sent.objects[0];
  EXPECT_EQ(ball.id, 7U);
  EXPECT_EQ(ball.layer, 1U);
  EXPECT_EQ(ball.changed_in_frame, 1000U);
  EXPECT_EQ(ball.motion.position_mm, from.motion.position_mm);
  EXPECT_EQ(ball.motion.velocity_mm_s, from.motion.velocity_mm_s);
  EXPECT_EQ(ball.motion.acceleration_mm_s2, from.motion.acceleration_mm_s2);
  EXPECT_EQ(ball.motion.angle_rad, 0.25);
  EXPECT_EQ(ball.motion.angular_velocity_rad_s, -0.5);
  EXPECT_EQ(ball.motion.reference_point, ReferencePoint::kCentreOfMass);
  EXPECT_EQ(ball.motion.quality, 0.75);
  EXPECT_EQ(ball.motion.visible_fraction, 0.5);
  ASSERT_TRUE(ball.grid);
  EXPECT_EQ(ball.grid->velocity_mm_s, from.grid->velocity_mm_s);
  EXPECT_EQ(ball.grid->acceleration_mm_s2, from.grid->acceleration_mm_s2);
  ASSERT_EQ(ball.impacts.size(), 2U);
  EXPECT_EQ(ball.impacts[1].time, from.impacts[1].time);
  EXPECT_EQ(ball.impacts[1].delta_velocity_mm_s, from.impacts[1].delta_velocity_mm_s);
  EXPECT_EQ(ball.material.stiffness_N_mm, 0.5);
  EXPECT_EQ(ball.material.damping_Ns_m, 1.0);
  EXPECT_EQ(ball.material.static_friction, 0.25);
  EXPECT_EQ(ball.material.dynamic_friction, 0.0) << "none, which is not the viewer's default";
  EXPECT_EQ(ball.material.texture_K_mm, std::nullopt) << "nothing was said of it";
  EXPECT_EQ(got.objects[1].material, Material{});
  EXPECT_FALSE(got.objects[1].relief) << "left out means unchanged";
  EXPECT_FALSE(got.objects[1].grid);
  EXPECT_EQ(got.objects[1].changed_in_frame, 990U);
}

TEST(Wire, CarriesEachFieldOfAMaterialAloneAndItsZero) {
  const std::vector<std::optional<double> Material::*> fields = {
      &Material::stiffness_N_mm,   &Material::damping_Ns_m, &Material::static_friction,
      &Material::dynamic_friction, &Material::texture_K_mm, &Material::mass_kg};
  for (const auto field : fields) {
    for (const double value : {0.0, 0.5}) {
      HapticFrame frame = goldenFrame();
      frame.objects[0].material = {};
      frame.objects[0].material.*field = value;
      EXPECT_EQ(roundTrip(frame).objects[0].material, frame.objects[0].material);
    }
  }
}

TEST(Wire, HeightsKeepWithinTheBoundAndMasksExactly) {
  for (const int width : {1, 7, 8, 9, 64, 1920}) {
    HapticFrame frame = goldenFrame();
    frame.objects[0].grid = nullptr;
    const Relief sent = randomRelief({0, 2, width, 5}, static_cast<std::uint32_t>(width), 30.0F);
    frame.objects[0].relief = std::make_shared<Relief>(sent);
    const CodedFrame got = roundTrip(frame);
    ASSERT_TRUE(got.objects[0].relief);
    EXPECT_TRUE(got.objects[0].relief->whole());
    const Relief relief = testing::decodedRelief(*got.objects[0].relief);
    EXPECT_EQ(relief.rect, sent.rect);
    EXPECT_EQ(relief.mask, sent.mask);
    ASSERT_EQ(relief.height_mm.size(), sent.height_mm.size());
    for (std::size_t i = 0; i < sent.height_mm.size(); ++i) {
      EXPECT_NEAR(relief.height_mm[i], sent.height_mm[i], testing::kFinestSlices.error_mm);
    }
  }
}

TEST(Wire, SlicesOfAReliefStayAsTheyAre) {
  const CodedFrame sent = testing::coded(goldenFrame());
  EXPECT_EQ(*roundTrip(sent).objects[0].relief, *sent.objects[0].relief);
}

TEST(FrameCoder, CodesAReliefOnceForAsLongAsItStays) {
  FrameCoder coder;
  HapticFrame frame = goldenFrame();
  const auto first = coder.code(frame).objects[0].relief;
  EXPECT_EQ(coder.code(frame).objects[0].relief, first);
  EXPECT_NE(coder.code(frame, testing::kFinestSlices).objects[0].relief, first) << "another bound";
  frame.objects[0].relief = std::make_shared<Relief>(*frame.objects[0].relief);
  EXPECT_NE(coder.code(frame, testing::kFinestSlices).objects[0].relief, first);
  EXPECT_FALSE(coder.code(frame).objects[1].relief) << "left out means unchanged";
}

}  // namespace
}  // namespace hapticast
