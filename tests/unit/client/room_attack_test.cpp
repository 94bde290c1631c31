// SPDX-License-Identifier: MIT
// Attacks on the room by its stream: real frames through the pool under a virtual clock. The tip is
// held still, so the hand explains nothing: whatever the stream does, the force may change by S per
// tick and no more. That bound knows nothing of the chain's own meter.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "client/device/device_profile.hpp"
#include "client/haptics/room.hpp"
#include "unit/client/frame_builder.hpp"
#include "unit/client/rig.hpp"

namespace hapticast::client {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr PixelRect kPlate_px{240, 160, 160, 160};  // +-20 mm about the middle of the picture

/// A plate whose middle is `height_mm` high.
PlayObject plateAt(double height_mm, std::uint32_t id = 1, double slope = 0.0) {
  static std::map<std::pair<double, double>, std::shared_ptr<const HeightField>> fields;
  auto& field = fields[{height_mm, slope}];
  if (!field) {
    field = makeField(
        kPlate_px, Workspace{}, [=](const Vec2& at) { return height_mm + slope * at.x(); },
        [](const Vec2&) { return true; });
  }
  return makeObject(id, field.get(), {0.0, 0.0, height_mm});
}

/// The room, a stream and a tip that stands still in the device frame.
class Attack {
 public:
  explicit Attack(const RoomSettings& room_settings, double tip_height_mm = 8.0)
      : settings(room_settings),
        room(std::make_unique<Room>(settings, pool, controls, reports, nullptr)) {
    const DeviceMapping mapping = DeviceMapping::fit(Workspace{}, settings.profile.workspace_mm);
    state.position_mm = mapping.toDevice({0.1, 0.1, tip_height_mm});
    control.connected = true;
    control.first_epoch = epoch;
    control.playout_delay_target = Duration(60'000'000);
    next_s = toSeconds(clock.now().time_since_epoch());
  }

  /// One tick; the stream goes on with `scene` at 25 frames/s while `streaming`.
  const TickReport& step() {
    clock.advance(Duration(1'000'000));
    const double now_s = toSeconds(clock.now().time_since_epoch());
    while (next_s <= now_s) {
      if (streaming) publish(next_s);
      next_s += 0.04;
    }
    controls.store(control);
    state.time = clock.now();
    const Vec3 before_N = room->report().force_N;
    const TickReport& report = room->tick(clock.now(), state);
    check(report, before_N);
    return report;
  }
  const TickReport& run(int ticks) {
    for (int i = 1; i < ticks; ++i) (void)step();
    return step();
  }
  void publish(double media_s) {
    PlayFrame frame;
    frame.epoch = epoch;
    frame.id = ++id;
    frame.media_time = mediaTime(media_s);
    scene(frame, media_s);
    (void)send(pool, frame);
  }
  void add(PlayFrame& frame, const PlayObject& object) {
    frame.objects[frame.object_count++] = object;
  }

  ManualClock clock;
  RoomSettings settings;
  FramePool pool;
  LatestValue<Controls> controls;
  LatestValue<TickReport> reports;
  std::unique_ptr<Room> room;
  Controls control;
  DeviceState state;
  std::function<void(PlayFrame&, double)> scene = [](PlayFrame&, double) {};
  std::uint32_t epoch = 1;
  std::uint64_t id = 0;
  bool streaming = true;
  double next_s = 0.0;
  double max_force_N = 0.0;
  double max_step_N = 0.0;
  std::string name;

 private:
  void check(const TickReport& report, const Vec3& before_N) {
    const DeviceProfile& profile = settings.profile;
    const double force_N = report.force_N.norm();
    const double step_N = (report.force_N - before_N).norm();
    const double allowed_N =
        force_N > before_N.norm() ? profile.slew_rise_N_per_tick : profile.slew_fall_N_per_tick;
    ASSERT_TRUE(report.force_N.allFinite()) << name;
    ASSERT_LE(force_N, profile.peak_N + 1e-9) << name;
    ASSERT_LE(step_N, allowed_N + 1e-9) << name << ", tick " << report.tick;
    ASSERT_EQ(report.step_excess_N, 0.0) << name << ", tick " << report.tick;
    max_force_N = std::max(max_force_N, force_N);
    max_step_N = std::max(max_step_N, step_N);
  }
};

std::vector<RoomSettings> everyRoom() {
  std::vector<RoomSettings> rooms;
  for (const char* profile : {"omni", "falcon"}) {
    for (const SurfaceKind surface : {SurfaceKind::kNormal, SurfaceKind::kPerturbed}) {
      for (const Interpolation interpolation :
           {Interpolation::kHermite, Interpolation::kLinear, Interpolation::kHold}) {
        for (const Method method : {Method::kHapticast, Method::kThesis}) {
          if (method == Method::kThesis && interpolation != Interpolation::kHermite) continue;
          RoomSettings room;
          room.profile = loadDeviceProfile(profile);
          room.profile.delay_ticks = static_cast<int>(rooms.size() % 6);
          room.surface = surface;
          room.interpolation = interpolation;
          room.method = method;
          rooms.push_back(room);
        }
      }
    }
  }
  return rooms;
}

TEST(RoomAttack, EpochsIdsAndHolesInContact) {
  for (const RoomSettings& room : everyRoom()) {
    Attack attack(room);
    attack.name = "a plate 2 mm above the tip";
    attack.scene = [&](PlayFrame& frame, double) { attack.add(frame, plateAt(10.0)); };
    EXPECT_GT(attack.run(1500).force_N.z(), 0.3);
    attack.name = "another plate in a new epoch every 0.5 s";
    for (int i = 0; i < 6; ++i) {
      ++attack.epoch;
      const double height_mm = i % 2 == 0 ? 9.0 : 13.0;
      attack.scene = [&attack, height_mm](PlayFrame& frame, double) {
        attack.add(frame, plateAt(height_mm));
      };
      (void)attack.run(500);
    }
    attack.name = "a new id every frame";
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0, static_cast<std::uint32_t>(frame.id)));
    };
    (void)attack.run(500);
    attack.name = "gone every third frame";
    attack.scene = [&](PlayFrame& frame, double) {
      if (frame.id % 3 != 0) attack.add(frame, plateAt(10.0));
    };
    (void)attack.run(1000);
    attack.name = "without a relief every third frame";
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0));
      if (frame.id % 3 == 0) frame.objects[0].field = nullptr;
    };
    (void)attack.run(1000);
  }
}

TEST(RoomAttack, ADeepObjectThatVanishesLetsTheForceRampDown) {
  for (const SurfaceKind surface : {SurfaceKind::kNormal, SurfaceKind::kPerturbed}) {
    RoomSettings room;
    room.surface = surface;
    Attack attack(room);
    bool there = true;
    attack.scene = [&](PlayFrame& frame, double) {
      if (there) attack.add(frame, plateAt(13.0));
    };
    const double before_N = attack.run(1500).force_N.norm();
    EXPECT_GT(before_N, 2.0);
    there = false;
    attack.max_step_N = 0.0;
    EXPECT_EQ(attack.run(300).force_N, Vec3(Vec3::Zero()));
    EXPECT_LE(attack.max_step_N, room.profile.residue_N_per_tick + 1e-9);
  }
}

TEST(RoomAttack, AnObjectThatAppearsAboveTheTip) {
  for (const RoomSettings& room : everyRoom()) {
    for (const double above_mm : {1.0, 3.0, 20.0}) {
      Attack attack(room);
      attack.name = "appears";
      bool there = false;
      attack.scene = [&](PlayFrame& frame, double) {
        if (there) attack.add(frame, plateAt(8.0 + above_mm));
      };
      (void)attack.run(500);
      there = true;
      const double scale = DeviceMapping::fit(Workspace{}, room.profile.workspace_mm).scale;
      const TickReport& report = attack.run(1000);
      const double limit_mm = std::max(2.0, room.profile.peak_N / room.profile.stiffness_N_mm);
      if (above_mm * scale > limit_mm) {
        EXPECT_EQ(attack.max_force_N, 0.0);
      } else {
        EXPECT_GT(report.force_N.norm(), 0.1);
        EXPECT_LT(attack.max_step_N, 0.1);  // it fades in
      }
    }
  }
}

TEST(RoomAttack, TwoObjectsThatSwapWhichIsDeepest) {
  for (const RoomSettings& room : everyRoom()) {
    Attack attack(room);
    attack.name = "opposite slopes";
    attack.scene = [&](PlayFrame& frame, double time_s) {
      const double by_mm = 0.4 * std::sin(9.0 * time_s);
      attack.add(frame, plateAt(11.0, 1, 1.0));
      attack.add(frame, plateAt(11.0, 2, -1.0));
      frame.objects[0].motion.position_mm.z() += by_mm;
      frame.objects[1].motion.position_mm.z() -= by_mm;
    };
    (void)attack.run(3000);
    EXPECT_GT(attack.max_force_N, 0.3);
  }
}

TEST(RoomAttack, StiffnessFromTheStream) {
  for (const RoomSettings& room : everyRoom()) {
    Attack attack(room);
    attack.name = "stiffness";
    const double values[] = {0.05, 10.0, 0.3, 1e9, 1e-9, -1.0, kNaN, 0.5, kInfinity, 2.0, 0.0};
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0));
      frame.objects[0].material.stiffness_N_mm = values[frame.id / 5 % std::size(values)];
    };
    (void)attack.run(6000);
    EXPECT_GT(attack.max_force_N, 0.3);
  }
}

TEST(RoomAttack, LateFramesThatCorrectAnExtrapolation) {
  for (const RoomSettings& room : everyRoom()) {
    for (const double speed_mm_s : {60.0, 300.0, 900.0}) {
      Attack attack(room, 5.0);
      attack.name = "late correction";
      // It is said to move, but does not: every extrapolation is wrong by up to 72 mm.
      attack.streaming = false;
      double sent_s = attack.next_s;
      attack.scene = [&](PlayFrame& frame, double) {
        attack.add(frame, plateAt(7.0));
        frame.objects[0].motion.velocity_mm_s = {0.3 * speed_mm_s, 0.0, speed_mm_s};
      };
      for (int i = 0; i < 4000; ++i) {
        (void)attack.step();
        // Every frame arrives 20..79 ms after it is due.
        const double due_s =
            toSeconds(attack.clock.now().time_since_epoch()) - 0.08 - 0.02 * (i / 40 % 4);
        while (sent_s <= due_s) attack.publish(sent_s), sent_s += 0.04;
      }
    }
  }
}

/// Sets one number of an object to `value`.
using Poison = void (*)(PlayObject&, double);
constexpr Poison kPoisons[] = {
    [](PlayObject& o, double x) { o.motion.position_mm.x() = x; },
    [](PlayObject& o, double x) { o.motion.position_mm.z() = x; },
    [](PlayObject& o, double x) { o.motion.velocity_mm_s.y() = x; },
    [](PlayObject& o, double x) { o.motion.velocity_mm_s.z() = x; },
    [](PlayObject& o, double x) { o.motion.acceleration_mm_s2.x() = x; },
    [](PlayObject& o, double x) { o.motion.acceleration_mm_s2.z() = x; },
    [](PlayObject& o, double x) { o.motion.angle_rad = x; },
    [](PlayObject& o, double x) { o.motion.angular_velocity_rad_s = x; },
    [](PlayObject& o, double x) { o.motion.quality = x; },
    [](PlayObject& o, double x) { o.material.stiffness_N_mm = x; },
    [](PlayObject& o, double x) { o.material.texture_K_mm = x; },
    [](PlayObject& o, double x) {
      o.impact_count = kMaxImpacts;
      for (Impact& impact : o.impacts) impact.delta_velocity_mm_s = {0.0, 0.0, x};
    },
    [](PlayObject& o, double x) {
      o.impact_count = 1'000'000;
      o.impacts[0].time = MediaTime(Duration(x > 0.0 ? std::numeric_limits<std::int64_t>::max()
                                                     : std::numeric_limits<std::int64_t>::min()));
    },
};

TEST(RoomAttack, PoisonInEveryFieldAndThenItComesBack) {
  for (const RoomSettings& room : everyRoom()) {
    for (std::size_t field = 0; field < std::size(kPoisons); ++field) {
      for (const double value : {kNaN, kInfinity, -kInfinity, 1e308, -1e308, 1e12, -1e12, 5e3}) {
        Attack attack(room);
        attack.name = "field " + std::to_string(field) + " = " + std::to_string(value);
        bool poisoned = false;
        attack.scene = [&](PlayFrame& frame, double) {
          attack.add(frame, plateAt(9.5));
          if (poisoned) {
            for (Impact& impact : frame.objects[0].impacts) impact.time = frame.media_time;
            kPoisons[field](frame.objects[0], value);
          }
        };
        (void)attack.run(500);
        poisoned = true;
        (void)attack.run(60);  // between a good and a bad frame
        (void)attack.run(100);
        poisoned = false;
        const TickReport& report = attack.run(700);
        EXPECT_GT(report.force_N.norm(), 0.1) << attack.name;
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(RoomAttack, FramesOfTheFarFutureOrPastDoNotKeepOldDataAlive) {
  for (const RoomSettings& room : everyRoom()) {
    for (const std::int64_t when_ns :
         {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max() / 2,
          std::int64_t{60'000'000'000}, std::int64_t{0},
          std::numeric_limits<std::int64_t>::min()}) {
      Attack attack(room);
      attack.name = "a frame at " + std::to_string(when_ns);
      attack.scene = [&](PlayFrame& frame, double) { attack.add(frame, plateAt(10.0)); };
      (void)attack.run(1000);
      PlayFrame strange;
      strange.epoch = attack.epoch;
      strange.id = ++attack.id;
      strange.media_time = MediaTime(Duration(when_ns));
      attack.add(strange, plateAt(10.0));
      ASSERT_TRUE(send(attack.pool, strange));
      EXPECT_GT(attack.run(1000).force_N.norm(), 0.3);
      attack.streaming = false;  // 40 ms of frames, 80 of extrapolation, to 300 held, 100 of fade
      (void)attack.run(40 + 300 + 100 + 60);
      for (int i = 0; i < 1000; ++i) ASSERT_EQ(attack.step().force_N, Vec3(Vec3::Zero()));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(RoomAttack, AStaleStreamFadesToExactlyZeroAndComesBackByDepth) {
  for (const RoomSettings& room : everyRoom()) {
    for (const double above_mm : {1.5, 25.0}) {
      Attack attack(room);
      attack.name = "stale";
      double height_mm = 9.5;
      attack.scene = [&](PlayFrame& frame, double) { attack.add(frame, plateAt(height_mm)); };
      EXPECT_GT(attack.run(1000).force_N.norm(), 0.1);
      attack.streaming = false;
      const double newest_s = attack.next_s - 0.04;
      for (int i = 0; i < 1000; ++i) {
        const TickReport& report = attack.step();
        const double age_s = toSeconds(report.play_time.time_since_epoch()) - newest_s;
        if (age_s > 0.0) {
          const Lookup expected = age_s <= 0.08    ? Lookup::kExtrapolated
                                  : age_s <= 0.300 ? Lookup::kHeld
                                                   : Lookup::kFaded;
          if (std::abs(age_s - 0.08) > 1e-6 && std::abs(age_s - 0.3) > 1e-6) {
            ASSERT_EQ(report.lookup, expected) << age_s;
          }
        }
        if (age_s > 0.402) {
          ASSERT_EQ(report.force_N, Vec3(Vec3::Zero())) << age_s;
        }
      }
      height_mm = 8.0 + above_mm;  // it goes on, at once
      attack.streaming = true;
      attack.max_force_N = attack.max_step_N = 0.0;
      const TickReport& report = attack.run(1000);
      if (above_mm > 20.0) {
        EXPECT_EQ(attack.max_force_N, 0.0);  // deep: unarmed until the hand has left
      } else {
        EXPECT_GT(report.force_N.norm(), 0.1);
        EXPECT_LT(attack.max_step_N, 0.1);
      }
    }
  }
}

/// Everything at once, by chance.
void chaos(const RoomSettings& room, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto chance = [&](double p) { return std::uniform_real_distribution(0., 1.)(random) < p; };
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(random);
  };
  Attack attack(room);
  attack.name = "chaos " + std::to_string(seed);
  attack.scene = [&](PlayFrame& frame, double) {
    const int count = static_cast<int>(between(0.5, 4.0));
    for (int i = 0; i < count; ++i) {
      const double slope = 0.5 * std::floor(between(-3.0, 3.99));
      PlayObject object = plateAt(std::floor(between(6.0, 14.0)),
                                  static_cast<std::uint32_t>(chance(0.9) ? i : 7), slope);
      const double fast = chance(0.1) ? 1e4 : 100.0;
      object.motion.velocity_mm_s = {between(-fast, fast), between(-fast, fast),
                                     between(-fast, fast)};
      object.motion.acceleration_mm_s2 = 30.0 * Vec3::Constant(between(-fast, fast));
      object.motion.angular_velocity_rad_s = chance(0.1) ? between(-100.0, 100.0) : 0.0;
      object.material.stiffness_N_mm = chance(0.3) ? between(0.0, 8.0) : 0.0;
      if (chance(0.1)) object.impacts[object.impact_count++] = {frame.media_time, {0, 0, fast}};
      if (chance(0.02)) kPoisons[random() % std::size(kPoisons)](object, kNaN);
      attack.add(frame, object);
    }
  };
  for (int i = 0; i < 20'000; ++i) {
    if (chance(0.002)) attack.streaming = !attack.streaming;
    if (!attack.streaming && chance(0.02)) attack.publish(attack.next_s - between(0.0, 0.3));
    if (chance(0.001)) ++attack.epoch;
    if (chance(0.001)) attack.control.paused = !attack.control.paused;
    if (chance(0.001)) attack.control.connected = !attack.control.connected;
    if (chance(0.001)) attack.control.first_epoch = attack.epoch = attack.epoch + 1;
    if (chance(0.002)) attack.control.clock_offset = Duration(std::int64_t(between(-1e8, 1e8)));
    if (chance(0.002))
      attack.control.playout_delay_target = Duration(std::int64_t(between(0, 4e8)));
    if (chance(0.001)) attack.control.workspace.width_mm = chance(0.5) ? 160.0 : 100.0;
    if (chance(0.001)) ++attack.control.rearm;
    const double luck = between(0.0, 1.0);
    attack.state.status = luck < 0.0002  ? DeviceStatus::kLost
                          : luck < 0.002 ? DeviceStatus::kNoData
                                         : DeviceStatus::kOk;
    (void)attack.step();
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(attack.max_force_N, 0.5) << attack.name;
}

TEST(RoomAttack, ChaosDoesNotStepAHandThatStandsStill) {
  unsigned seed = 0;
  for (const RoomSettings& room : everyRoom()) {
    for (int i = 0; i < 3; ++i) chaos(room, ++seed);
  }
}

}  // namespace
}  // namespace hapticast::client
