// SPDX-License-Identifier: MIT
// The built-in drivers of makers' libraries beside the real client, helper and server: stand-ins of
// the libraries simulate a device, and misbehave in the ways that a library can.
#include <nlohmann/json.hpp>

#include "tests/integration/driver_fixture.hpp"

namespace hapticast::testing {
namespace {

constexpr int kFailed = 1;  // no device, or no server
constexpr int kWrongUsage = 2;
constexpr double kWidthToHeight = 1.5;  // x to y of both stand-ins: 3 mm to the right, 2 mm up

/// A force at the motors.
struct MotorForce {
  double t_s = 0.0;  // local clock
  Vec3 force_N = Vec3::Zero();
};

std::vector<MotorForce> readMotors(const Trace& trace) {
  const std::uint64_t end = trace->exchanges;
  std::vector<MotorForce> forces;
  for (std::uint64_t i = end < STANDIN_FORCES ? 0 : end - STANDIN_FORCES; i < end; ++i) {
    const standin_force& each = trace->forces[i % STANDIN_FORCES];
    forces.push_back({1e-9 * static_cast<double>(each.at_ns),
                      {each.force_N[0], each.force_N[1], each.force_N[2]}});
  }
  return forces;
}

/// Leaves out the half second in which the helper fades a force in after a silence.
std::vector<MotorForce> steadyForces(const std::vector<MotorForce>& all) {
  std::vector<MotorForce> forces;
  double silent_s = 0.0, last_s = 0.0;
  for (const MotorForce& each : all) {
    if (each.t_s - last_s > 0.01 || each.force_N == Vec3::Zero()) silent_s = each.t_s;
    last_s = each.t_s;
    if (each.t_s - silent_s > 0.6) forces.push_back(each);
  }
  return forces;
}

/// Leaves out the forces that the helper reduces after a pause of the client. The helper reduces a
/// force whose command is older than 10 ms, and then fades it in within half a second (force_gate).
/// The log has no row during the pause. `log` begins `begin_s` after the clock.
std::vector<MotorForce> commandedForces(const std::vector<MotorForce>& motors,
                                        const std::vector<LogRow>& log, double begin_s) {
  std::vector<MotorForce> forces;
  std::size_t at = 0;
  double pause_end_s = -1.0;
  for (const MotorForce& each : motors) {
    // 30 ms more: the alignment of the clocks is unknown by 20 ms.
    for (; at < log.size() && log[at].t_s + begin_s <= each.t_s + 0.03; ++at) {
      if (at > 0 && log[at].t_s - log[at - 1].t_s > 0.008) pause_end_s = log[at].t_s + begin_s;
    }
    if (each.t_s - pause_end_s > 0.6) forces.push_back(each);
  }
  return forces;
}

/// Relative difference (rms) between each force at the motors and the one that the log has then,
/// two ticks more or less, where the log begins `begin_s` after the clock.
double relativeError(const std::vector<MotorForce>& motors, const std::vector<LogRow>& log,
                     double begin_s) {
  double error = 0.0, whole = 0.0;
  std::size_t at = 0;
  for (const MotorForce& each : motors) {
    while (at + 1 < log.size() && log[at + 1].t_s + begin_s <= each.t_s) ++at;
    double least = each.force_N.squaredNorm();
    for (std::size_t i = at < 2 ? 0 : at - 2; i < std::min(at + 3, log.size()); ++i)
      least = std::min(least, (log[i].force_N - each.force_N).squaredNorm());
    error += least;
    whole += each.force_N.squaredNorm();
  }
  return std::sqrt(error / whole);
}

/// The log does not say when on the clock it begins: the first force is the same one in both.
double relativeError(const std::vector<MotorForce>& all, const std::vector<LogRow>& log) {
  const auto acts = [](const auto& each) { return each.force_N != Vec3::Zero(); };
  const auto motor = std::find_if(all.begin(), all.end(), acts);
  const auto row = std::find_if(log.begin(), log.end(), acts);
  if (motor == all.end() || row == log.end()) return 1.0;
  const double begin_s = motor->t_s - row->t_s;
  const auto motors = commandedForces(steadyForces(all), log, begin_s);
  if (motors.empty()) return 1.0;
  double best = 1.0;
  for (int ms = -20; ms <= 20; ++ms)
    best = std::min(best, relativeError(motors, log, begin_s + 1e-3 * ms));
  return best;
}

class ProgramsDriversTest : public ProgramsWithDriverTest {
 protected:
  static std::string libraryFile(const std::string& name) {
    return std::string(HAPTICAST_STANDINS) + "/" + name + ".so";
  }
  /// The client beside the stand-in library `library` with a fault.
  std::unique_ptr<Process> startBeside(const std::string& library, const std::string& fault,
                                       const Trace& trace,
                                       const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"XDG_DATA_HOME=" + path("data"), "FAKE_TRACE=" + trace.file(),
                                 "FAKE_FAULT=" + fault, HAPTICAST_CLIENT_PROGRAM};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--device-option", "library=" + libraryFile(library)});
    return start("/usr/bin/env", all);
  }
  /// What the client says before it ends with `exit_code`.
  std::string runBeside(const std::string& library, const std::string& fault, const Trace& trace,
                        const std::vector<std::string>& arguments, int exit_code) const {
    const auto client = startBeside(library, fault, trace, arguments);
    EXPECT_EQ(client->wait(kSoon), exit_code) << client->output();
    EXPECT_EQ(client->output().find('\x1b'), std::string::npos);
    return client->output();
  }
  void touchAndCompare(const std::string& device, const std::string& library) const;
  nlohmann::json readSummary(const std::string& file) const {
    std::ifstream in(path(file));
    return nlohmann::json::parse(in);
  }
};

void ProgramsDriversTest::touchAndCompare(const std::string& device,
                                          const std::string& library) const {
  const auto server = startStillServer();
  const Trace trace(path("trace"));
  const auto client = startBeside(library, "", trace,
                                  {addressOf(*server), "--view", "off", "--device", device, "--log",
                                   path("log.csv"), "--summary", path("summary.json")});
  EXPECT_TRUE(waitUntil(kSoon, [&] {
    return !client->running() || steadyForces(readMotors(trace)).size() > 2500;
  })) << client->output();
  interrupt(*client);
  const auto motors = readMotors(trace);
  const auto log = readLog(path("log.csv"));
  ASSERT_GT(steadyForces(motors).size(), 100U) << client->output();
  const double error = relativeError(motors, log);
  Vec3 most_N = Vec3::Zero();
  for (const MotorForce& each : motors) most_N = most_N.cwiseMax(each.force_N.cwiseAbs());
  EXPECT_LT(error, 0.02);
  EXPECT_GT(most_N.minCoeff(), 0.02) << "no axis remains untested";
  EXPECT_NEAR(log.back().hip_mm.x() / log.back().hip_mm.y(), kWidthToHeight, 0.01) << "axes";
  EXPECT_LE(most_N.norm(), 3.3 + 1e-9) << "no watchdog of its own";
  EXPECT_EQ(trace->force_N, 0.0);
  EXPECT_EQ(trace->opened, trace->closed);
  EXPECT_GT(readSummary("summary.json").at("contact_ticks"), 200);
  interrupt(*server);
}

TEST_F(ProgramsDriversTest, ADhdDeviceRendersTheForcesOfTheLog) {
  touchAndCompare("dhd", "fake_dhd");
}

// Faults that the helper finds at any driver are those of programs_device_test.cpp.
constexpr ContactFault kDhdFaults[] = {
    {"nan", "its driver reported a position that is not a number"},
    {"frozen", ""},
    {"timeguard", ""},
    {"saturated", ""},
    {"position_fails", "dhd: the device reports an error: communication"},
    {"loose", "dhd: the device answers again"},
    {"hang", "its driver does not return from a call; the helper ends it"},
};

TEST_F(ProgramsDriversTest, ATouchRendersTheForcesOfTheLog) { touchAndCompare("touch", "fake_hd"); }

constexpr ContactFault kHdFaults[] = {
    {"nan", "its driver reported a position that is not a number"},
    {"frozen", ""},
    {"limited", "touch: its library reports: some error"},
    {"warm", "touch: its motors are warm"},
    {"comm_error", "touch: its library reports: communication"},
    {"fault", "the device does not answer: no force from now on"},
    {"loose", "the device does not answer: no force from now on"},
    {"slow", ""},
    {"hang", "touch: its library does not call back; the motors are off"},
};

/// The parameter: what the library does while a force acts.
class ProgramsFaultyLibraryTest : public ProgramsDriversTest,
                                  public ::testing::WithParamInterface<ContactFault> {
 protected:
  void misbehaveInContact(const char* device, const char* library) const {
    const auto touch = [&](const auto& address, const Trace& trace, const std::string& fault) {
      return startBeside(library, fault, trace,
                         {address, "--view", "off", "--device", device, "--fault-dir",
                          path("faults"), "--summary", path("summary.json")});
    };
    ASSERT_NO_FATAL_FAILURE(ProgramsDriversTest::misbehaveInContact(GetParam(), 4, touch));
    const std::string fault = GetParam().name;
    if (fault == "saturated" || fault == "limited") {
      EXPECT_GT(readSummary("summary.json").at("device").at("saturated"), 0);
    }
  }
};

class ProgramsFaultyDhdTest : public ProgramsFaultyLibraryTest {};
TEST_P(ProgramsFaultyDhdTest, EndsAtZeroWithOneLine) { misbehaveInContact("dhd", "fake_dhd"); }
INSTANTIATE_TEST_SUITE_P(Faults, ProgramsFaultyDhdTest, ::testing::ValuesIn(kDhdFaults),
                         [](const auto& fault) { return std::string(fault.param.name); });

class ProgramsFaultyHdTest : public ProgramsFaultyLibraryTest {};
TEST_P(ProgramsFaultyHdTest, EndsAtZeroWithOneLine) { misbehaveInContact("touch", "fake_hd"); }
INSTANTIATE_TEST_SUITE_P(Faults, ProgramsFaultyHdTest, ::testing::ValuesIn(kHdFaults),
                         [](const auto& fault) { return std::string(fault.param.name); });

/// A start beside a stand-in library, its exit code, and a part of what the client says.
struct Opening {
  const char* library;
  const char* fault;
  const char* device;  ///< "": --list-devices
  std::vector<std::string> options;
  int exit_code;
  const char* line;
};

TEST_F(ProgramsDriversTest, DevicesAreSelectedAndThoseThatDoNotOpenEndWithTheirReason) {
  const std::vector<Opening> openings = {
      {"fake_dhd",
       "open_fails",
       "dhd",
       {},
       kFailed,
       "--device dhd: no device opens: communication ?[31merror; is it plugged in"},
      {"fake_dhd",
       "enable_fails",
       "dhd",
       {},
       kFailed,
       "--device dhd: the device refuses forces: communication"},
      {"fake_dhd_other",
       "",
       "dhd",
       {},
       kFailed,
       "fake_dhd_other.so lacks dhdGetPosition(): is it the one of Force"},
      {"absent", "", "dhd", {}, kWrongUsage, "absent.so: cannot be loaded"},
      {"fake_dhd", "", "", {}, 0, "; serial number 4711; serial number 4712\n"},
      {"fake_dhd", "", "dhd", {"serial=4712"}, kFailed, "(dhd, serial number 4712)"},
      {"fake_dhd", "", "dhd", {"serial=99"}, kFailed, "no free device has the serial number 99"},
      {"fake_dhd_old",
       "",
       "dhd",
       {"serial=4712"},
       kFailed,
       "cannot select a device by its serial number"},
      {"fake_hd",
       "open_fails",
       "touch",
       {},
       kFailed,
       "--device touch: no device opens: communication ?[31merror; is it connected"},
      {"fake_hd",
       "no_callback",
       "touch",
       {},
       kFailed,
       "--device touch: its library does not call back"},
      {"fake_hd_other",
       "",
       "touch",
       {},
       kFailed,
       "fake_hd_other.so lacks hdSetDoublev(): is it the one of OpenHaptics?"},
      {"fake_hd", "", "", {}, 0, "; serial number D1\n"},
      {"fake_hd",
       "",
       "touch",
       {"serial=D2"},
       kFailed,
       "the device has the serial number D1, not D2; --device-option name=NAME"},
      {"fake_hd", "", "touch", {"serial=D2", "name=Left"}, kFailed, "(touch, serial number D2)"},
  };
  for (const Opening& opening : openings) {
    const Trace trace(path("trace"));
    std::vector<std::string> arguments{"--list-devices"};
    if (*opening.device != '\0')
      arguments = {"--view", "off", "--device", opening.device, "--seconds", "1"};
    for (const std::string& option : opening.options)
      arguments.insert(arguments.end(), {"--device-option", option});
    const std::string output =
        runBeside(opening.library, opening.fault, trace, arguments, opening.exit_code);
    EXPECT_NE(output.find(opening.line), std::string::npos) << opening.line << "\n" << output;
    EXPECT_EQ(trace->force_N, 0.0);
    EXPECT_EQ(trace->opened, trace->closed) << opening.line;
  }
}

TEST_F(ProgramsDriversTest, FreeGripsPassTheCheck) {
  ::setenv("STANDIN_HAND", "free", 1);
  for (const auto& [device, library] : {std::pair{"dhd", "fake_dhd"}, {"touch", "fake_hd"}}) {
    const Trace trace(path(std::string(device) + ".trace"));
    const std::string output = runBeside(library, "", trace, {"--check-device", device}, 0);
    EXPECT_NE(output.find("check: the device follows in sign and axis"), std::string::npos);
    EXPECT_LE(trace->most_N, 0.3 + 1e-9);
    EXPECT_EQ(trace->force_N, 0.0);
  }
  ::unsetenv("STANDIN_HAND");
}

TEST_F(ProgramsDriversTest, ATouchWaitsForItsInkwell) {
  const auto server = startStillServer();
  const Trace trace(path("trace"));
  const auto client = startBeside("fake_hd", "inkwell", trace,
                                  {addressOf(*server), "--view", "off", "--device", "touch"});
  EXPECT_TRUE(client->says("put the stylus into its inkwell", kSoon)) << client->output();
  EXPECT_EQ(trace->most_N, 0.0);
  EXPECT_TRUE(client->says("touch: calibrated", kSoon)) << client->output();
  EXPECT_TRUE(waitUntil(kSoon, [&] { return trace->force_N > 0.3; })) << client->output();
  interrupt(*client);
  EXPECT_EQ(trace->force_N, 0.0);
  interrupt(*server);
}

TEST_F(ProgramsDriversTest, OneFoundByItselfRendersNoForce) {
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  for (const auto& [device, library] : {std::pair{"dhd", "fake_dhd"}, {"touch", "fake_hd"}}) {
    const Trace trace(path(std::string(device) + ".trace"));
    const auto client = startBeside(library, "", trace, {address, "--view", "off"});
    EXPECT_TRUE(client->says("detected this device automatically: no force until", kSoon))
        << client->output();
    EXPECT_TRUE(client->says(std::string("(") + device, kSoon)) << client->output();
    EXPECT_TRUE(client->says("connected", kSoon)) << client->output();
    const std::uint64_t connected = trace->exchanges;
    EXPECT_TRUE(waitUntil(kSoon, [&] { return trace->exchanges > connected + 5000; }));
    interrupt(*client);
    EXPECT_EQ(trace->most_N, 0.0);
  }
  const Trace trace(path("none.trace"));
  const auto client = startBeside("fake_dhd", "none", trace, {address, "--view", "off"});
  EXPECT_TRUE(client->says("with a virtual device", kSoon)) << client->output();
  interrupt(*client);
  EXPECT_EQ(trace->opened, 0U);
  interrupt(*server);
}

TEST_F(ProgramsDriversTest, AnAbsentLibraryIsOneLineAndAutoStaysQuiet) {
  const auto run = [&](std::vector<std::string> arguments, int exit_code) {
    const auto client = startClient(std::move(arguments));
    EXPECT_EQ(client->wait(kSoon), exit_code) << client->output();
    return client->output();
  };
  const std::string remedy =
      " was not found; install it or name it with --device-option library=FILE";
  const std::string dhd = "the library libdhd.so of Force Dimension's SDK" + remedy;
  const std::string touch = "the library libHD.so of OpenHaptics" + remedy;
  EXPECT_EQ(countOccurrences(dhd, run({"--device", "dhd", "--view", "off"}, kFailed)), 1U);
  EXPECT_EQ(countOccurrences(touch, run({"--device", "touch", "--view", "off"}, kFailed)), 1U);
  const std::string list = run({"--list-devices"}, 0);
  EXPECT_EQ(countOccurrences(dhd, list), 1U) << list;
  EXPECT_EQ(countOccurrences(touch, list), 1U) << list;
  EXPECT_EQ(run({"--view", "off", "--seconds", "1"}, kFailed).find("library"), std::string::npos);
}

}  // namespace
}  // namespace hapticast::testing
