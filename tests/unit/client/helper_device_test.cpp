// SPDX-License-Identifier: MIT
// The parts of the helper process, each by itself: gate, check of readings, profile, messages,
// page.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "client/device/helper/driver_files.hpp"
#include "client/device/helper/driver_profile.hpp"
#include "client/device/helper/messages.hpp"
#include "client/device/helper/program/force_gate.hpp"
#include "client/device/helper/program/helper_loop.hpp"
#include "client/device/helper/shared_page.hpp"
#include "client/device/helper/state_check.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {
namespace {

using namespace std::chrono_literals;
constexpr LocalTime kBegin{5s};

DeviceCommand commandAt(LocalTime time, double force_N) {
  DeviceCommand command;
  command.force_N[2] = force_N;
  command.time_ns = time.time_since_epoch().count();
  return command;
}

/// Runs a gate for some ms with a client that is alive. Returns the last force.
double runFresh(ForceGate& gate, LocalTime& now, int ms, double force_N = 2.0) {
  double last_N = 0.0;
  for (int i = 0; i < ms; ++i, now += 1ms)
    last_N = gate.computeForce_N(commandAt(now, force_N), true, now).z();
  return last_N;
}

TEST(ForceGate, AStaleHeartbeatMeansZeroWithin21msWithoutAStep) {
  ForceGate gate;
  LocalTime now = kBegin;
  ASSERT_EQ(runFresh(gate, now, 1000), 2.0);
  const DeviceCommand last = commandAt(now - 1ms, 2.0);
  double before_N = 2.0;
  int ms_to_zero = 0;
  for (; ms_to_zero < 100 && before_N > 0.0; ++ms_to_zero, now += 1ms) {
    const double force_N = gate.computeForce_N(last, true, now).z();
    EXPECT_LE(before_N - force_N, 0.2 + 1e-9) << "a tenth in each ms";
    before_N = force_N;
  }
  EXPECT_LE(ms_to_zero, 21);
  EXPECT_TRUE(gate.atZero());
  // The force returns over half a second.
  EXPECT_NEAR(runFresh(gate, now, 100), 0.4, 0.02);
  EXPECT_EQ(runFresh(gate, now, 500), 2.0);
  EXPECT_FALSE(gate.reduces());
}

TEST(ForceGate, ADeadClientMeansZeroWithin11ms) {
  ForceGate gate;
  LocalTime now = kBegin;
  (void)runFresh(gate, now, 1000);
  for (int i = 0; i < 11; ++i, now += 1ms)
    (void)gate.computeForce_N(commandAt(now, 2.0), false, now);
  EXPECT_TRUE(gate.atZero());
}

TEST(ForceGate, NoNumberIsNoForceAndAClosedGateOpensSlowly) {
  ForceGate gate;
  LocalTime now = kBegin;
  (void)runFresh(gate, now, 1000);
  EXPECT_EQ(gate.computeForce_N(commandAt(now, std::nan("")), true, now), Vec3(Vec3::Zero()));
  gate.close();
  EXPECT_LT(runFresh(gate, now, 2), 0.02);
}

DeviceReading readingAt(std::uint64_t number, LocalTime time, const Vec3& position_mm) {
  DeviceReading reading;
  reading.number = number;
  reading.state.size = sizeof reading.state;
  reading.state.status = HAPTICAST_OK;
  std::copy_n(position_mm.data(), 3, reading.state.position_mm);
  reading.state.taken_ns = time.time_since_epoch().count();
  return reading;
}

TEST(StateCheck, AcceptsReadingsThatAHandCanCause) {
  StateCheck check({160.0, 120.0, 70.0});
  EXPECT_EQ(check.check({}, kBegin).status, DeviceStatus::kNoData);
  const DeviceState first = check.check(readingAt(1, kBegin, {1.0, 2.0, 3.0}), kBegin);
  EXPECT_EQ(first.status, DeviceStatus::kOk);
  EXPECT_EQ(first.position_mm, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(check.check(readingAt(1, kBegin, {1.0, 2.0, 3.0}), kBegin + 1ms).status,
            DeviceStatus::kNoData)
      << "the same reading again";
  EXPECT_EQ(check.check(readingAt(2, kBegin + 1ms, {5.9, 2.0, 3.0}), kBegin + 1ms).status,
            DeviceStatus::kOk)
      << "4.9 m/s";
}

TEST(StateCheck, EachImpossibleReadingIsNoReadingAndIsCounted) {
  using Finding = StateCheck::Finding;
  StateCheck check({160.0, 120.0, 70.0});
  const LocalTime now = kBegin + 10ms;
  (void)check.check(readingAt(1, kBegin, Vec3::Zero()), kBegin);
  std::uint64_t number = 1;
  const auto reject = [&](const DeviceReading& reading, Finding finding) {
    const std::uint64_t before = check.count(finding);
    const DeviceState state = check.check(reading, now);
    EXPECT_NE(state.status, DeviceStatus::kOk);
    EXPECT_EQ(state.position_mm, Vec3(Vec3::Zero())) << "the last good one";
    EXPECT_EQ(check.count(finding), before + 1) << toText(finding);
  };
  const double inf = std::numeric_limits<double>::infinity();
  reject(readingAt(++number, now, {std::nan(""), 0.0, 0.0}), Finding::kNotFinite);
  reject(readingAt(++number, now, {0.0, inf, 0.0}), Finding::kNotFinite);
  reject(readingAt(++number, now, {0.0, 181.0, 0.0}), Finding::kOutside);
  reject(readingAt(++number, now, {0.0, 0.0, 51.0}), Finding::kTooFast);
  reject(readingAt(++number, kBegin - 1ms, Vec3::Zero()), Finding::kTimeBack);
  reject(readingAt(++number, now + 1ms, Vec3::Zero()), Finding::kFuture);
  DeviceReading odd = readingAt(++number, now, Vec3::Zero());
  odd.state.status = 3;
  reject(odd, Finding::kStatus);
  EXPECT_EQ(check.check(readingAt(++number, now, {0.0, 0.0, 49.0}), now).status, DeviceStatus::kOk);
}

TEST(StateCheck, ALostDeviceStaysLostUntilItAnswers) {
  StateCheck check({160.0, 120.0, 70.0});
  DeviceReading lost = readingAt(1, kBegin, Vec3::Zero());
  lost.state.status = HAPTICAST_LOST;
  EXPECT_EQ(check.check(lost, kBegin).status, DeviceStatus::kLost);
  EXPECT_EQ(check.check(lost, kBegin + 1ms).status, DeviceStatus::kLost);
  EXPECT_EQ(check.check(readingAt(2, kBegin + 2ms, Vec3::Zero()), kBegin + 2ms).status,
            DeviceStatus::kOk);
  EXPECT_EQ(check.check(readingAt(3, kBegin + 2ms, Vec3::Zero()), kBegin + 30ms).status,
            DeviceStatus::kNoData)
      << "28 ms old";
}

TEST(StateCheck, AFirstReadingWithTheLeastTimeIsTooOld) {
  StateCheck check({160.0, 120.0, 70.0});
  EXPECT_EQ(check.check(readingAt(1, LocalTime::min(), Vec3::Zero()), kBegin).status,
            DeviceStatus::kNoData);
}

TEST(StateCheck, RandomBytesGiveFinitePositionsWithinTheWorkspace) {
  std::mt19937_64 random(20261126);
  StateCheck check({160.0, 120.0, 70.0});
  for (int i = 0; i < 100'000; ++i) {
    DeviceReading reading;
    auto* const bytes = reinterpret_cast<std::uint64_t*>(&reading);
    for (std::size_t word = 0; word < sizeof reading / 8; ++word) bytes[word] = random();
    if (i % 2 == 0) reading.state.status = HAPTICAST_OK;
    if (i % 4 == 0) reading.state.taken_ns = kBegin.time_since_epoch().count() + i;
    const DeviceState state = check.check(reading, kBegin + Duration(i));
    ASSERT_TRUE(state.position_mm.allFinite());
    ASSERT_LE(state.position_mm.cwiseAbs().maxCoeff(), 240.0);
  }
}

TEST(DriverProfile, EachValueIsLimitedAndAnUnknownOneIsCareful) {
  const PlantProfile unknown = convertProfile("mine", unknownProfile(), "");
  EXPECT_EQ(unknown.name, "mine");
  EXPECT_LT(unknown.mass_kg, 0.045) << "never overstated";
  EXPECT_GT(unknown.count_mm, 0.055);
  EXPECT_GE(unknown.delay_ticks, 2);
  hapticast_profile absurd = unknownProfile();
  absurd.mass_kg = 1e9;
  absurd.peak_N = std::numeric_limits<double>::infinity();
  absurd.continuous_N = -5.0;
  absurd.workspace_mm[1] = std::nan("");
  absurd.delay_ticks = 1000;
  absurd.enable_button = 77;
  const PlantProfile limited = convertProfile("mine", absurd, "");
  EXPECT_LE(limited.mass_kg, 1.0);
  EXPECT_EQ(limited.peak_N, 3.3);
  EXPECT_LE(limited.continuous_N, limited.peak_N);
  EXPECT_TRUE(limited.workspace_mm.allFinite());
  EXPECT_EQ(limited.delay_ticks, 5);
  EXPECT_FALSE(limited.enable_button);
}

TEST(DriverProfile, AStrongDeviceNeedsAWatchdogOrTheUsersProfile) {
  hapticast_profile strong = unknownProfile();
  strong.peak_N = 8.0;
  EXPECT_EQ(convertProfile("mine", strong, "").peak_N, 3.3);
  EXPECT_EQ(convertProfile("mine", strong, "falcon").peak_N, 8.0) << "the user allows it";
  strong.watchdog_ms = 20;
  const PlantProfile watchdog_profile = convertProfile("mine", strong, "");
  EXPECT_EQ(watchdog_profile.peak_N, 8.0);
  EXPECT_NEAR(watchdog_profile.slew_rise_N_per_tick, 0.2 * 8.0 / 3.3, 1e-12);
  strong.delay_ticks = 3;
  EXPECT_EQ(convertProfile("mine", strong, "falcon").delay_ticks, 3) << "the longer one";
}

TEST(HelperMessages, ArriveAsOneCleanLineAndTheEndIsSeen) {
  int sockets[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, sockets), 0);
  const SteadyClock clock;
  const auto receive = [&] { return receiveMessage(sockets[1], clock.now() + 60s); };
  EXPECT_TRUE(sendMessage(sockets[0], {.text = "\x1b[31mred\nline"}));
  EXPECT_EQ(receive().message->text, "?[31mred?line");
  EXPECT_TRUE(sendMessage(sockets[0], {.text = std::string(5000, 'x')}));
  EXPECT_EQ(receive().message->text.size(), 300U);
  EXPECT_TRUE(sendMessage(sockets[0],
                          {.kind = HelperMessage::Kind::kFound, .text = "S1", .problem = "busy"}));
  const auto found = receive();
  EXPECT_EQ(found.message->text + "|" + found.message->problem, "S1|busy");
  HelperMessage opened{.kind = HelperMessage::Kind::kOpened, .profile = unknownProfile()};
  opened.profile.mass_kg = 0.5;
  EXPECT_TRUE(sendMessage(sockets[0], opened));
  EXPECT_EQ(receive().message->profile.mass_kg, 0.5);
  for (const std::string& bytes : {std::string("Q?"), std::string("Oshort")}) {
    ASSERT_GT(send(sockets[0], bytes.data(), bytes.size(), 0), 0);
    EXPECT_FALSE(receive().message) << bytes;
  }
  close(sockets[0]);
  EXPECT_TRUE(receive().ended);
  close(sockets[1]);
}

TEST(DriverFiles, NamesAreShortAndPlain) {
  EXPECT_TRUE(isDriverName("inverse3"));
  EXPECT_TRUE(isDriverName("my_arm_2"));
  for (const char* name : {"", "../x", "A", "a.b", "a b", "a/b"})
    EXPECT_FALSE(isDriverName(name)) << name;
  EXPECT_FALSE(isDriverName(std::string(33, 'a')));
  EXPECT_EQ(loadDriverFile("absent", {"/nowhere"}), nullptr);
}

TEST(SeqLock, AReaderNeverSeesAMixture) {
  struct Pair {
    std::uint64_t a = 0, b = 0, c = 0;
  };
  SeqLock<Pair> lock;
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; !stop; ++i) lock.store({i, 2 * i, 3 * i});
  });
  Pair pair;
  std::uint64_t last = 0;
  int loads = 0;
  for (int i = 0; i < 200'000; ++i) {
    if (!lock.load(pair)) continue;
    ++loads;
    ASSERT_EQ(pair.b, 2 * pair.a);
    ASSERT_EQ(pair.c, 3 * pair.a);
    ASSERT_GE(pair.a, last);
    last = pair.a;
  }
  stop = true;
  writer.join();
  EXPECT_GT(loads, 0);
}

}  // namespace
}  // namespace hapticast::client
