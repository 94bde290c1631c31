// SPDX-License-Identifier: MIT
// The unmodified client with a Falcon below its libusb, streaming from a real server.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "client/device/falcon/kinematics.hpp"
#include "tests/falcon/falcon_arms.hpp"
#include "tests/falcon/falcon_fixture.hpp"

namespace hapticast::testing {
namespace {

struct Logged {
  double t_s = 0.0;
  Vec3 force_N = Vec3::Zero();
};

class FalconClient : public FalconTest {
 protected:
  void TearDown() override {
    client_.reset();
    server_.reset();
  }
  void startServer() {
    server_ = std::make_unique<Process>(
        std::vector<std::string>{HAPTICAST_SERVER_PROGRAM, "--source", "synthetic:still", "--loop",
                                 "--listen", "127.0.0.1:0"});
    ASSERT_TRUE(server_->says("listening on ", kPatience)) << server_->output();
    const std::string text = server_->output();
    const std::size_t begin = text.find("listening on ") + 13;
    address_ = text.substr(begin, text.find(';', begin) - begin);
  }
  void startClient(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {HAPTICAST_CLIENT_PROGRAM, address_, "--view", "off"});
    client_ = std::make_unique<Process>(arguments);
  }
  /// The hand presses the grip into the middle of the picture, and lets it out again.
  void aim(double z_mm) {
    port_->with([z_mm](FalconModel& model, BusFaults&) {
      model.target_m = client::kFalconCentre_m + 1e-3 * Vec3(0.0, 0.0, z_mm);
    });
  }
  /// Returns whether the hand has held the grip at its target for the last 100 requests.
  bool restsAtTarget() {
    constexpr std::ptrdiff_t kRest_requests = 100;
    return port_->with([](FalconModel& model, BusFaults&) {
      const auto& all = model.received();
      return std::ssize(all) > kRest_requests &&
             std::all_of(all.end() - kRest_requests, all.end(), [&](const ReceivedRequest& each) {
               return (each.position_m - model.target_m).norm() < 0.5e-3;
             });
    });
  }
  /// Time from `begin` to the first zero that stays.
  double timeToZero_s(LocalTime begin) {
    const auto all = received();
    LocalTime zero = begin;
    for (const ReceivedRequest& each : all) {
      if (each.request.motors != kNoTorque) zero = LocalTime{};
      if (each.request.motors == kNoTorque && zero == LocalTime{}) zero = each.at;
    }
    return toSeconds(std::max(zero - begin, Duration{}));
  }
  /// The client's child.
  pid_t findHelper() const {
    std::ifstream in(fmt::format("/proc/{0}/task/{0}/children", client_->id()));
    pid_t helper = 0;
    in >> helper;
    return helper;
  }
  bool acts() {
    const auto all = received();
    return !all.empty() && all.back().request.motors != kNoTorque;
  }
  void touch() {
    ASSERT_TRUE(client_->says("Falcon: ready", kPatience)) << client_->output();
    ASSERT_TRUE(client_->says("connected", kPatience)) << client_->output();
    const auto touches = [&] {
      aim(20.0);
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      aim(-5.0);
      return waitUntil(std::chrono::seconds(1), [&] { return acts(); });
    };
    ASSERT_TRUE(waitUntil(kPatience, touches)) << client_->output();
  }
  std::vector<Logged> loggedForces(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::vector<Logged> forces;
    while (std::getline(in, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      double skipped = 0.0;
      Logged row;
      words >> row.t_s;
      for (int i = 0; i < 4; ++i) words >> skipped;
      words >> row.force_N.x() >> row.force_N.y() >> row.force_N.z();
      if (words) forces.push_back(row);
    }
    return forces;
  }

  std::string address_;
  std::unique_ptr<Process> server_;
  std::unique_ptr<Process> client_;
};

/// Force at the grip that these motors make there.
Vec3 forceOf(const ReceivedRequest& received) {
  const auto& motors = received.request.motors;
  return forceAt_N(received.position_m, Vec3(motors[0], motors[1], motors[2]), client::kFalconGain);
}

/// Each force that came at the motors beside the one of the log that was decided then, two ticks
/// more or less, where the log begins `begin_s` after the clock.
double relativeError(const std::vector<Logged>& sent, const std::vector<Logged>& logged,
                     double begin_s) {
  double error = 0.0;
  double whole = 0.0;
  std::size_t at = 0;
  for (const Logged& each : sent) {
    while (at + 1 < logged.size() && logged[at + 1].t_s + begin_s <= each.t_s) ++at;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = at < 2 ? 0 : at - 2; i < std::min(at + 3, logged.size()); ++i)
      least = std::min(least, (logged[i].force_N - each.force_N).squaredNorm());
    error += least;
    whole += each.force_N.squaredNorm();
  }
  return std::sqrt(error / whole);
}

/// The log does not say when on the clock it begins: with one of the first requests after the
/// helper has measured the delay, the one that fits best.
double relativeError(const std::vector<ReceivedRequest>& received, const std::vector<Logged>& sent,
                     const std::vector<Logged>& logged) {
  double best = 1.0;
  for (std::size_t i = 0; i < std::min<std::size_t>(received.size(), 1500); ++i) {
    for (int ms = -3; ms <= 3; ++ms)
      best = std::min(best, relativeError(sent, logged, toSeconds(received[i].at) + 1e-3 * ms));
  }
  return best;
}

/// The motors' result, without the half second of ramp that follows a silence.
std::vector<Logged> steadyForces(const std::vector<ReceivedRequest>& received) {
  std::vector<Logged> forces;
  LocalTime silent{};
  LocalTime last{};
  for (const ReceivedRequest& each : received) {
    const bool gap = each.at - last > std::chrono::milliseconds(10);
    if (gap || each.request.motors == kNoTorque) silent = each.at;
    last = each.at;
    if (each.at - silent > std::chrono::milliseconds(600))
      forces.push_back({toSeconds(each.at), forceOf(each)});
  }
  return forces;
}

TEST_F(FalconClient, TouchesTheStreamAndTheMotorsGetTheForcesOfTheLog) {
  bootAndPlugIn();
  startServer();
  const std::string log = (folder_ / "log.csv").string();
  const std::string summary = (folder_ / "summary.json").string();
  startClient({"--device", "falcon", "--log", log, "--summary", summary});
  EXPECT_TRUE(client_->says("pull the grip out", kPatience)) << client_->output();
  touch();
  EXPECT_TRUE(waitUntil(kPatience, [&] {  // without friction it slides aside: again and again
    aim(15.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    aim(-5.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(3000));
    return steadyForces(received()).size() > 150;
  }));
  client_->signal(SIGINT);
  EXPECT_EQ(client_->wait(kPatience), 0) << client_->output();
  expectZeroAtLast();

  const std::vector<Logged> sent = steadyForces(received());
  const auto logged = loggedForces(log);
  ASSERT_GT(logged.size(), 1000U);
  ASSERT_GT(sent.size(), 150U) << client_->output();
  const double error = relativeError(received(), sent, logged);
  std::printf("%zu forces at the motors, %.2f %% from the log\n", sent.size(), 100.0 * error);
  EXPECT_LT(error, 0.02);
  std::ifstream in(summary);
  const auto json = nlohmann::json::parse(in);
  EXPECT_GT(json.at("device").at("round_trips"), 1000);
  EXPECT_GT(json.at("contact_ticks"), 200);
  EXPECT_EQ(json.at("step_excess_max_N"), 0.0);
}

TEST_F(FalconClient, OneFoundByItselfGivesNoForceUntilItsButtonIsPressed) {
  bootAndPlugIn();
  startServer();
  startClient({});
  ASSERT_TRUE(client_->says("detected this device automatically: no force until", kPatience))
      << client_->output();
  ASSERT_TRUE(client_->says("Falcon: ready", kPatience)) << client_->output();
  ASSERT_TRUE(client_->says("connected", kPatience)) << client_->output();
  aim(-15.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(800));
  for (const ReceivedRequest& each : received()) ASSERT_EQ(each.request.motors, kNoTorque);
  aim(20.0);
  port_->with([](FalconModel& model, BusFaults&) { model.buttons = 1; });
  ASSERT_TRUE(client_->says("re-armed", kPatience)) << client_->output();
  touch();
  client_->signal(SIGTERM);
  EXPECT_EQ(client_->wait(kPatience), 0) << client_->output();
  expectZeroAtLast();
}

TEST_F(FalconClient, GoesOnWithoutOneThatIsPulledOutAndTakesItBack) {
  bootAndPlugIn();
  startServer();
  startClient({"--device", "falcon", "--rearm"});
  touch();
  port_->unplug();
  ASSERT_TRUE(client_->says("the connection is lost; no force", kPatience)) << client_->output();
  bootAndPlugIn();
  aim(0.0);
  ASSERT_TRUE(client_->says("the connection is restored", kPatience)) << client_->output();
  ASSERT_TRUE(client_->says("Falcon: ready", kPatience, 2)) << client_->output();
  touch();
  client_->signal(SIGINT);
  EXPECT_EQ(client_->wait(kPatience), 0) << client_->output();
  expectZeroAtLast();
}

/// However the client ends in contact, the helper commands zero.
TEST_F(FalconClient, EachSignalInContactEndsWithZeroAtTheMotors) {
  for (const int signal : {SIGKILL, SIGSEGV, SIGABRT, SIGUSR1}) {
    SCOPED_TRACE(strsignal(signal));
    if (client_) port_->unplug();
    bootAndPlugIn();
    if (!server_) startServer();
    startClient({"--device", "falcon"});
    touch();
    if (HasFatalFailure()) return;
    client_->signal(signal);
    const LocalTime sent = clock_.now();
    (void)client_->wait(kPatience);
    EXPECT_TRUE(waitUntil(kPatience, [&] { return !acts(); }));
    std::printf("%s: zero after %.1f ms\n", strsignal(signal), 1e3 * timeToZero_s(sent));
    expectZeroAtLast();
  }
}

TEST_F(FalconClient, AStoppedClientMeansZeroAndItsForceReturnsSlowly) {
  bootAndPlugIn();
  startServer();
  startClient({"--device", "falcon", "--rearm"});
  touch();
  client_->signal(SIGSTOP);
  const LocalTime sent = clock_.now();
  EXPECT_TRUE(waitUntil(kPatience, [&] { return !acts(); }));
  std::printf("SIGSTOP: zero after %.1f ms\n", 1e3 * timeToZero_s(sent));
  client_->signal(SIGCONT);
  touch();
  client_->signal(SIGINT);
  EXPECT_EQ(client_->wait(kPatience), 0) << client_->output();
  expectZeroAtLast();
}

TEST_F(FalconClient, AKilledHelperIsReplacedByOneThatCommandsZero) {
  bootAndPlugIn();
  startServer();
  startClient({"--device", "falcon", "--rearm"});
  touch();
  const pid_t helper = findHelper();
  ASSERT_GT(helper, 0);
  ASSERT_EQ(kill(helper, SIGKILL), 0);
  const LocalTime sent = clock_.now();
  EXPECT_TRUE(waitUntil(kPatience, [&] { return !acts(); }));
  std::printf("helper killed: zero after %.1f ms\n", 1e3 * timeToZero_s(sent));
  EXPECT_TRUE(client_->says("its driver ended (signal 9 (Killed)); no force", kPatience))
      << client_->output();
  EXPECT_TRUE(client_->says("its driver runs again", kPatience)) << client_->output();
  touch();
  client_->signal(SIGINT);
  EXPECT_EQ(client_->wait(kPatience), 0) << client_->output();
  expectZeroAtLast();
}

/// How often no command arrived for so long.
std::ptrdiff_t countGaps(const std::vector<ReceivedRequest>& received, Duration longest) {
  std::ptrdiff_t count = 0;
  for (std::size_t i = 1; i < received.size(); ++i)
    count += received[i].at - received[i - 1].at > longest ? 1 : 0;
  return count;
}

/// How often a hold was broken.
std::ptrdiff_t stalls(const std::vector<ReceivedRequest>& received) {
  return countGaps(received, std::chrono::milliseconds(18));
}

TEST_F(FalconClient, ACalibrationThatATerminalEndsLeavesZero) {
  for (const int signal : {SIGHUP, SIGTERM, SIGKILL}) {
    SCOPED_TRACE(strsignal(signal));
    if (client_) port_->unplug();
    bootAndPlugIn();
    client_ = std::make_unique<Process>(
        std::vector<std::string>{HAPTICAST_CLIENT_PROGRAM, "--falcon-calibrate", "200"});
    ASSERT_TRUE(client_->says("Falcon: ready", kPatience)) << client_->output();
    ASSERT_TRUE(waitUntil(kPatience, [&] { return acts(); }));
    client_->signal(signal);
    (void)client_->wait(kPatience);
    EXPECT_TRUE(waitUntil(kPatience, [&] { return !acts(); }));
    expectZeroAtLast();
  }
}

TEST_F(FalconClient, AWeightThatIsTooHeavyIsNamedAndLetDown) {
  bootAndPlugIn();
  port_->with([](FalconModel& model, BusFaults&) { model.gain = 10000.0; });
  client_ = std::make_unique<Process>(
      std::vector<std::string>{HAPTICAST_CLIENT_PROGRAM, "--falcon-calibrate", "500"});
  ASSERT_TRUE(client_->says("Falcon: ready", kPatience)) << client_->output();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  port_->with([](FalconModel& model, BusFaults&) { model.let_go = true; });
  ASSERT_TRUE(client_->says("2. hang 500 g", kPatience)) << client_->output();
  port_->with([](FalconModel& model, BusFaults&) { model.weight_kg = 0.5; });
  EXPECT_EQ(client_->wait(kPatience), 1) << client_->output();
  EXPECT_TRUE(client_->says("the motors cannot hold this weight", kPatience)) << client_->output();
  expectZeroAtLast();
}

TEST_F(FalconClient, CalibratesItsGainWithAWeight) {
  bootAndPlugIn();
  port_->with([](FalconModel& model, BusFaults&) { model.gain = 3000.0; });
  const std::string config = folder_.write("client.cfg", "quiet = false\n");
  client_ = std::make_unique<Process>(std::vector<std::string>{
      HAPTICAST_CLIENT_PROGRAM, "--falcon-calibrate", "200", "--config", config});
  ASSERT_TRUE(client_->says("Falcon: ready", kPatience)) << client_->output();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  port_->with([](FalconModel& model, BusFaults&) { model.let_go = true; });
  const auto at_first = stalls(received());
  if (!client_->says("2. hang 200 g", kPatience) && stalls(received()) > at_first + 4)
    GTEST_SKIP() << "this machine is too busy to hold a grip for two seconds";
  port_->with([](FalconModel& model, BusFaults&) { model.weight_kg = 0.2; });
  const auto before = stalls(received());
  const bool rested = client_->says("3. hold the weight", kPatience);
  if (!rested && stalls(received()) > before + 4)
    GTEST_SKIP() << "this machine is too busy to hold a grip for two seconds";
  EXPECT_EQ(client_->wait(kPatience), 0) << client_->output();
  std::ifstream in(config);
  std::string first;
  std::string second;
  std::getline(in, first);
  std::getline(in, second);
  EXPECT_EQ(first, "quiet = false");
  ASSERT_EQ(second.rfind("falcon-gain = ", 0), 0U) << second;
  std::printf("gain 3000, found %s\n", second.c_str());
  EXPECT_NEAR(std::stod(second.substr(14)), 3000.0, 90.0);
  expectZeroAtLast();
}

/// A pause of the machine, or of the emulated bus, looks like a delay of the device. So the check
/// may be repeated, as a user would; a wrong sign, mass or delay of the client fails each time.
TEST_F(FalconClient, AFreeGripPassesTheCheck) {
  bootAndPlugIn();
  std::optional<int> code;
  for (int attempt = 0; attempt < 5 && code != 0; ++attempt) {
    port_->with([](FalconModel& model, BusFaults&) { model.let_go = false; });
    client_ = std::make_unique<Process>(
        std::vector<std::string>{HAPTICAST_CLIENT_PROGRAM, "--check-device", "falcon"});
    ASSERT_TRUE(client_->says("Falcon: ready", kPatience)) << client_->output();
    aim(0.0);
    ASSERT_TRUE(waitUntil(kPatience, [this] { return restsAtTarget(); }));
    port_->with([](FalconModel& model, BusFaults&) { model.let_go = true; });
    code = client_->wait(std::chrono::seconds(100));  // it repeats what a pause spoils
    expectZeroAtLast();
  }
  const auto all = received();
  const std::ptrdiff_t late = countGaps(all, std::chrono::milliseconds(2));
  if (code != 0 && 50 * late > std::ssize(all))  // on a quiet machine 1 of 100 requests is late
    GTEST_SKIP() << late << " of " << all.size() << " requests were late on the emulated bus";
  EXPECT_EQ(code, 0) << client_->output();
}

TEST_F(FalconClient, WithoutADeviceItEndsWithOneLine) {
  startServer();
  startClient({"--device", "falcon"});
  EXPECT_EQ(client_->wait(kPatience), 1);
  EXPECT_TRUE(client_->says("--device falcon: none was found on USB", kPatience));
}

}  // namespace
}  // namespace hapticast::testing
