// SPDX-License-Identifier: MIT
// Wire data that is rejected: limits, texts, damage.
#include <functional>
#include <limits>
#include <random>

#include "common/protocol/scan.hpp"
#include "common/transport/framing.hpp"
#include "common/wire_limits.hpp"
#include "tests/support/golden_messages.hpp"
#include "tests/unit/common/wire_messages.hpp"

namespace hapticast {
namespace {

using testing::goldenDescription;
using testing::goldenFrame;
using testing::goldenMessages;
using testing::refusal;
using testing::roundTrip;
using Bytes = std::vector<std::uint8_t>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(WireRefuses, NumbersThatAreNotOrAreAbsurd) {
  using Change = std::function<void(HapticFrame&, double)>;
  const std::vector<std::pair<Change, double>> changes = {
      {[](auto& f, double x) { f.objects[0].motion.position_mm.x() = x; }, limits::kPosition_mm},
      {[](auto& f, double x) { f.objects[0].motion.velocity_mm_s.y() = x; },
       limits::kVelocity_mm_s},
      {[](auto& f, double x) { f.objects[1].motion.acceleration_mm_s2.z() = x; },
       limits::kAcceleration_mm_s2},
      {[](auto& f, double x) { f.objects[0].motion.angle_rad = x; }, limits::kAngle_rad},
      {[](auto& f, double x) { f.objects[0].motion.angular_velocity_rad_s = x; },
       limits::kAngularVelocity_rad_s},
      {[](auto& f, double x) { f.objects[0].motion.quality = x; }, 1.0},
      {[](auto& f, double x) { f.objects[0].motion.visible_fraction = x; }, 1.0},
      {[](auto& f, double x) { f.objects[0].impacts[0].delta_velocity_mm_s.x() = x; },
       limits::kVelocity_mm_s},
      {[](auto& f, double x) { f.objects[0].material.stiffness_N_mm = x; },
       limits::kStiffness_N_mm},
      {[](auto& f, double x) { f.objects[0].material.damping_Ns_m = x; }, limits::kDamping_Ns_m},
      {[](auto& f, double x) { f.objects[0].material.static_friction = x; }, limits::kFriction},
      {[](auto& f, double x) { f.objects[0].material.dynamic_friction = x; }, limits::kFriction},
      {[](auto& f, double x) { f.objects[0].material.texture_K_mm = x; }, limits::kWorkspace_mm},
      {[](auto& f, double x) { f.objects[0].material.mass_kg = x; }, limits::kMass_kg},
      {[](auto& f, double x) {
         auto grid = std::make_shared<MotionGrid>(*f.objects[0].grid);
         grid->velocity_mm_s[0].x() = static_cast<float>(x);
         f.objects[0].grid = grid;
       },
       limits::kVelocity_mm_s},
      {[](auto& f, double x) {
         auto grid = std::make_shared<MotionGrid>(*f.objects[0].grid);
         grid->acceleration_mm_s2[0].z() = static_cast<float>(x);
         f.objects[0].grid = grid;
       },
       limits::kAcceleration_mm_s2},
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto& [change, limit] = changes[i];
    HapticFrame frame = goldenFrame();
    change(frame, limit);
    EXPECT_NO_THROW(roundTrip(frame)) << i;
    for (const double bad : {kNan, kInfinity, -kInfinity, limit * 1.01}) {
      change(frame, bad);
      EXPECT_EQ(refusal(frame), ErrorCode::kMalformed) << i << " " << bad;
    }
  }
}

TEST(WireRefuses, MaterialsThatAreNegative) {
  for (const auto field :
       {&Material::stiffness_N_mm, &Material::damping_Ns_m, &Material::static_friction,
        &Material::dynamic_friction, &Material::texture_K_mm, &Material::mass_kg}) {
    HapticFrame frame = goldenFrame();
    frame.objects[0].material.*field = -0.001;
    EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  }
}

TEST(WireRefuses, GridsThatDoNotCoverTheRelief) {
  HapticFrame frame = goldenFrame();
  auto grid = std::make_shared<MotionGrid>(*frame.objects[0].grid);
  grid->columns = 2;
  frame.objects[0].grid = grid;
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  frame.objects[0].relief = nullptr;  // now the arrays are too short
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  grid->velocity_mm_s.resize(2, Eigen::Vector3f::Zero());
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  grid->acceleration_mm_s2.resize(2, Eigen::Vector3f::Zero());
  EXPECT_NO_THROW(roundTrip(frame));
  grid->columns = 121;
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
}

TEST(WireRefuses, OffersOfDatagramsThatCannotBeTaken) {
  Welcome welcome = testing::goldenWelcome();
  welcome.verifying_key.reset();
  EXPECT_EQ(refusal(welcome), ErrorCode::kMalformed) << "two origins for one stream";
  welcome = testing::goldenWelcome();
  welcome.group->port = 0;
  EXPECT_EQ(refusal(welcome), ErrorCode::kMalformed);
  welcome.group->port = 1;
  EXPECT_NO_THROW(roundTrip(welcome));
  welcome.group->address.assign(65, '1');
  EXPECT_EQ(refusal(welcome), ErrorCode::kTooLarge);
  for (const std::uint32_t copies : {0U, 5U})
    EXPECT_EQ(refusal(Delivery{true, true, copies}), ErrorCode::kMalformed);
}

TEST(WireRefuses, KeysTokensAndRequestsOfOperatorsThatAreOutOfRange) {
  Hello hello{kProtocolVersion, "x", false, true, std::string(256, 't')};
  EXPECT_NO_THROW(roundTrip(hello));
  hello.access_token += 't';
  EXPECT_EQ(refusal(hello), ErrorCode::kTooLarge);
  DatagramKey key = testing::goldenKey();
  key.id = 0;
  EXPECT_EQ(refusal(key), ErrorCode::kMalformed);
  key.id = 255;
  key.grace = std::chrono::milliseconds(60'001);
  EXPECT_EQ(refusal(key), ErrorCode::kMalformed);
  const std::vector<std::uint8_t> short_key{0x6a, 0x05, 0x08, 0x07, 0x12, 0x01, 0x00};
  EXPECT_FALSE(decode(short_key).ok());
  EXPECT_EQ(refusal(Control{{}, -0.5, {}}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(Control{{}, kNan, {}}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(Control{{}, {}, {1e9, {}, {}, {}, {}, {}}}), ErrorCode::kMalformed);
  const MediaTime late(Duration(1'000'000'000'000'000'001));
  EXPECT_EQ(refusal(Control{true, {}, {}, {}, {}, "", late}), ErrorCode::kMalformed);
  std::vector<std::uint8_t> name{0x72, 66, 0x32, 64};  // Control.operator_name
  name.resize(name.size() + 64, 'a');
  EXPECT_TRUE(decode(name).ok());
  name.push_back('a');
  ++name[1];
  ++name[3];
  ASSERT_FALSE(decode(name).ok());
  EXPECT_EQ(decode(name).error().code, ErrorCode::kTooLarge);
}

TEST(WireRefuses, CountsBeforeItAllocates) {
  HapticFrame frame = goldenFrame();
  while (frame.objects.size() < kMaxObjects) {
    frame.objects.push_back(frame.objects[1]);
    frame.objects.back().id = 100 + static_cast<std::uint32_t>(frame.objects.size());
  }
  EXPECT_NO_THROW(roundTrip(frame));
  frame.objects.push_back(frame.objects[1]);
  EXPECT_EQ(refusal(frame), ErrorCode::kTooLarge);
  frame = goldenFrame();
  frame.objects[0].impacts.resize(kMaxImpacts);
  EXPECT_NO_THROW(roundTrip(frame));
  frame.objects[0].impacts.resize(kMaxImpacts + 1);
  EXPECT_EQ(refusal(frame), ErrorCode::kTooLarge);
  // Two frames in one message would be merged into one with twice the objects.
  Bytes twice = encode(testing::coded(goldenFrame()));
  const Bytes once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_FALSE(decode(twice).ok());
}

/// A message whose frame holds `count` objects, each behind something that no version of ours knows
/// but every parser skips: fields of all kinds, groups, tags written longer than needed.
struct Padded {
  Bytes frame;
  Bytes message;

  Padded(std::uint8_t count, std::mt19937& random) {
    static const std::vector<Bytes> kUnknown = {
        {},
        {0xA3, 0x06, 0xA4, 0x06},                                      // an empty group
        {0xA3, 0x06, 0xAB, 0x06, 0x22, 0x00, 0xAC, 0x06, 0xA4, 0x06},  // a group in a group
        {0xA0, 0x06, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01},  // a varint
        {0xA1, 0x06, 1, 2, 3, 4, 5, 6, 7, 8},
        {0xA5, 0x06, 1, 2, 3, 4},
        {0xA2, 0x06, 0x02, 0x22, 0x00},                    // bytes that look like an object
        {0xA2, 0x86, 0x80, 0x80, 0x00, 0x01, 0x22},        // a tag in five bytes
        {0xA3, 0x06, 0x22, 0x80, 0x80, 0x00, 0xA4, 0x06},  // a length in three bytes
    };
    const std::vector<Bytes> object_tags = {{0x22}, {0xA2, 0x80, 0x80, 0x80, 0x00}, {0xA2, 0x00}};
    for (std::uint8_t id = 0; id < count; ++id) {
      append(kUnknown[random() % kUnknown.size()]);
      append(object_tags[random() % object_tags.size()]);
      append({0x02, 0x08, id});
    }
    append(kUnknown[random() % kUnknown.size()]);
    message = {0x32};  // field 6, the frame
    for (std::size_t rest = frame.size(); rest > 0 || message.size() == 1; rest >>= 7U) {
      message.push_back(static_cast<std::uint8_t>((rest & 0x7FU) | (rest > 0x7F ? 0x80U : 0U)));
    }
    message.insert(message.end(), frame.begin(), frame.end());
  }
  void append(const Bytes& bytes) { frame.insert(frame.end(), bytes.begin(), bytes.end()); }
};

TEST(WireRefuses, UnknownFieldsInExcess) {
  constexpr std::uint32_t kObjects = 4;  // field number
  std::mt19937 random(11);
  for (int round = 0; round < 400; ++round) {
    const auto count = static_cast<std::uint8_t>(random() % 40);
    const Padded padded(count, random);
    const auto counted = submessages(padded.frame, kObjects, kMaxObjects);
    ASSERT_EQ(counted.has_value(), count <= kMaxObjects) << int{count};
    const auto message = decode(padded.message);
    ASSERT_EQ(message.ok(), count <= kMaxObjects) << int{count};
    if (!message.ok()) {
      EXPECT_EQ(message.error().code, ErrorCode::kTooLarge);
      continue;
    }
    ASSERT_EQ(counted->size(), count);
    EXPECT_EQ(std::get<CodedFrame>(message.value()).objects.size(), count);
  }
}

TEST(WireRefuses, InconsistentObjects) {
  HapticFrame frame = goldenFrame();
  frame.objects[1].id = frame.objects[0].id;
  EXPECT_NO_THROW(roundTrip(frame)) << "another layer of the same object";
  frame.objects[1].layer = frame.objects[0].layer;
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  frame = goldenFrame();
  frame.objects[0].layer = kMaxObjects;
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  frame = goldenFrame();
  frame.objects[0].changed_in_frame = frame.id + 1;
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  frame = goldenFrame();
  frame.objects[0].motion.reference_point = static_cast<ReferencePoint>(9);
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
  frame = goldenFrame();
  frame.media_time = MediaTime(Duration(limits::kTime_ns + 1));
  EXPECT_EQ(refusal(frame), ErrorCode::kMalformed);
}

TEST(WireRefuses, DescriptionsOutOfRange) {
  const std::vector<std::function<void(StreamDescription&)>> changes = {
      [](auto& d) { d.fps = 0.5; },
      [](auto& d) { d.fps = 241.0; },
      [](auto& d) { d.fps = kNan; },
      [](auto& d) { d.workspace.width_px = 0; },
      [](auto& d) { d.workspace.width_px = 1921; },
      [](auto& d) { d.workspace.height_px = -1; },
      [](auto& d) { d.workspace.height_px = 1081; },
      [](auto& d) { d.workspace.width_mm = 0.0; },
      [](auto& d) { d.workspace.height_mm = kInfinity; },
      [](auto& d) { d.workspace.depth_mm = -30.0; },
      [](auto& d) { d.method = static_cast<Method>(2); },
      [](auto& d) { d.pipeline_latency = Duration(-1); },
      [](auto& d) { d.pipeline_latency = std::chrono::seconds(11); },
      [](auto& d) { d.largest_acceleration_mm_s2 = -1.0; },
      [](auto& d) { d.mass_kg = 0.0; },
      [](auto& d) { d.mass_kg = kNan; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    StreamDescription description = goldenDescription();
    changes[i](description);
    EXPECT_EQ(refusal(description), ErrorCode::kMalformed) << i;
    EXPECT_EQ(refusal(Welcome{1, 1, 0, description}), ErrorCode::kMalformed) << i;
  }
}

TEST(WireRefuses, BadVideoReportsAndErrors) {
  EXPECT_EQ(refusal(VideoFrame{0, 1, {}, {0x00, 0x01}}), ErrorCode::kMalformed) << "no JPEG";
  EXPECT_EQ(refusal(VideoFrame{0, 1, {}, {}}), ErrorCode::kMalformed);
  VideoFrame video{0, 1, {}, Bytes(limits::kJpeg, 0xFF)};
  video.jpeg[1] = 0xD8;
  EXPECT_NO_THROW(roundTrip(video));
  video.jpeg.push_back(0);
  EXPECT_EQ(refusal(video), ErrorCode::kTooLarge);
  EXPECT_EQ(refusal(PicturePart{1, {}, false}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(PicturePart{1, Bytes(limits::kPicturePart + 1), false}), ErrorCode::kTooLarge);
  EXPECT_EQ(refusal(PicturePart{limits::kPictureMessage + 1, {1}, false}), ErrorCode::kTooLarge);
  EXPECT_EQ(refusal(Receipt{1, std::chrono::seconds(11)}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(ReceiverReport{0, 0, 0, kNan, 0, false}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(ReceiverReport{0, 0, 0, 0, -1.0, false}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(WireError{static_cast<ErrorCode>(0), "x"}), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(WireError{static_cast<ErrorCode>(10), "x"}), ErrorCode::kMalformed);
  for (const double share : {-0.01, 1.01, kNan, kInfinity})
    EXPECT_EQ(refusal(Preparing{share}), ErrorCode::kMalformed) << share;
}

TEST(WireRefuses, MakesTextsShortAndPrintable) {
  EXPECT_EQ(roundTrip(Hello{1,
                            "a\nb\x7f"
                            "c",
                            false, true})
                .client_name,
            "a?b?c");
  EXPECT_EQ(roundTrip(Hello{1, "gr\xC3\xBC\xC3\x9F", false, true}).client_name,
            "gr\xC3\xBC\xC3\x9F");
  EXPECT_EQ(roundTrip(Hello{1, "bad\xFF\xC3", false, true}).client_name, "bad??");
  EXPECT_EQ(roundTrip(Hello{1, std::string(200, 'x'), false, true}).client_name.size(), 64U);
  // 63 bytes and then a character of two: it is left out whole.
  EXPECT_EQ(roundTrip(Hello{1, std::string(63, 'x') + "\xC3\xBC", false, true}).client_name.size(),
            63U);
}

TEST(WireRefuses, MalformedTexts) {
  const Bytes good = encode(Hello{1, "abcd", false, true});
  Bytes bad = good;
  bad[std::size_t(std::find(bad.begin(), bad.end(), 'c') - bad.begin())] = 0xFF;
  EXPECT_FALSE(decode(bad).ok()) << "no UTF-8";
  Bytes control = good;
  control[std::size_t(std::find(control.begin(), control.end(), 'c') - control.begin())] = '\n';
  EXPECT_EQ(std::get<Hello>(decode(control).value()).client_name, "ab?d")
      << "no line breaks in logs";
  Bytes too_long = {0x0A, 0x43, 0x12, 0x41};  // hello { client_name: 65 bytes }
  too_long.resize(too_long.size() + 65, 'x');
  EXPECT_EQ(decode(too_long).error().code, ErrorCode::kTooLarge);
}

TEST(WireRefuses, BytesThatAreNoMessage) {
  EXPECT_FALSE(decode({}).ok());
  EXPECT_FALSE(decode(Bytes{0x00}).ok());
  EXPECT_FALSE(decode(Bytes(16, 0xFF)).ok());
  EXPECT_EQ(decode(Bytes(kMaxMessageBytes + 1, 0)).error().code, ErrorCode::kTooLarge);
}

TEST(WireRefuses, SurvivesEveryTruncationAndRandomDamage) {
  std::mt19937 random(7);
  for (const auto& [name, message] : goldenMessages()) {
    const Bytes bytes = encode(message);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      (void)decode(std::span(bytes).first(size));
    }
    for (int round = 0; round < 3000; ++round) {
      Bytes damaged = bytes;
      for (int hits = 0; hits < 3; ++hits) {
        damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      }
      const auto decoded = decode(damaged);
      // What is taken can be sent on and is taken again.
      if (decoded.ok()) {
        EXPECT_TRUE(decode(encode(decoded.value())).ok()) << name;
      }
    }
  }
}

}  // namespace
}  // namespace hapticast
