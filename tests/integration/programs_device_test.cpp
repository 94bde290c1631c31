// SPDX-License-Identifier: MIT
// Drivers in files of their own beside the real client and helper: the stand-in driver misbehaves
// in every way that a driver can, and the example of client/device/drivers.md works as printed.
#include <sys/stat.h>

#include <string_view>

#include "tests/integration/driver_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsDeviceTest : public ProgramsWithDriverTest {
 protected:
  void SetUp() override {
    devices_ = path("data/hapticast/devices");
    std::filesystem::create_directories(devices_);
    install(HAPTICAST_STANDINS "/standin.so", "standin");
  }
  void install(const std::string& library, const std::string& name) const {
    const std::string file = devices_ + "/" + name + ".so";
    std::filesystem::copy_file(library, file, std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(chmod(file.c_str(), 0644), 0);
    ASSERT_EQ(chmod(devices_.c_str(), 0755), 0);
  }
  /// The client with this data folder and further variables.
  std::unique_ptr<Process> startWith(std::vector<std::string> arguments,
                                     const std::vector<std::string>& variables = {}) const {
    std::vector<std::string> all{"XDG_DATA_HOME=" + path("data")};
    all.insert(all.end(), variables.begin(), variables.end());
    all.emplace_back(HAPTICAST_CLIENT_PROGRAM);
    all.insert(all.end(), arguments.begin(), arguments.end());
    return start("/usr/bin/env", all);
  }
  std::unique_ptr<Process> touchWith(const std::string& address, const Trace& trace,
                                     const std::string& fault) const {
    return startWith({address, "--view", "off", "--device", "standin", "--device-option",
                      "trace=" + trace.file(), "--device-option", "fault=" + fault, "--summary",
                      path(fault + ".json"), "--fault-dir", path("faults")});
  }
  std::string devices_;
};

constexpr ContactFault kRunFaults[] = {
    {"nan", "its driver reported a position that is not a number"},
    {"jump", "its driver reported a jump of its position"},
    {"back", "its driver reported a position older than the one before"},
    {"future", "its driver reported a position with a time in the future"},
    {"status", "its driver reported an unknown status"},
    {"silent", ""},
    {"lost", "the device does not answer: no force from now on"},
    {"frozen", ""},
    {"slow", "an exchange of its driver lasted more than 0.5 ms"},
    {"segv", "its driver ended (signal 11 (Segmentation fault)); no force"},
    {"abort", "its driver ended (signal 6 (Aborted)); no force"},
    {"exit", "its driver ended (exit code 0); no force"},
    {"descriptors", "its driver ended"},
    {"rounding", ""},
    {"chatter", " lines more, not shown)"},
    {"wait_hangs", "its driver does not return from a call; the helper ends it"},
    {"exchange_hangs", "its driver does not return from a call; the helper ends it"},
};

/// The parameter: what the driver does while a force acts.
class ProgramsFaultyDriverTest : public ProgramsDeviceTest,
                                 public ::testing::WithParamInterface<ContactFault> {};

TEST_P(ProgramsFaultyDriverTest, EndsAtZeroWithOneLine) {
  if (!kFullSpeed && std::string_view(GetParam().name) == "segv")
    GTEST_SKIP() << "a sanitizer handles this signal";
  misbehaveInContact(GetParam(), 5,
                     [this](const auto& address, const Trace& trace, const auto& fault) {
                       return touchWith(address, trace, fault);
                     });
}
INSTANTIATE_TEST_SUITE_P(Faults, ProgramsFaultyDriverTest, ::testing::ValuesIn(kRunFaults),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(ProgramsDeviceTest, ADeviceLostInATrialOfAStudyMakesTheTrialVoidAndItComesAgain) {
  auto arguments = makeStudy(R"([{"name": "one"}, {"name": "two"}, {"name": "three"}])");
  const Trace trace(path("trace"));
  arguments.insert(arguments.end(), {"--device", "standin", "--device-option",
                                     "trace=" + trace.file(), "--device-option", "fault=lost"});
  const auto client = startWith(arguments);
  ASSERT_TRUE(client->says("trial 1 of 3", kSoon)) << client->output();
  trace->go = 1;
  const auto readEvents = [&] {
    std::ifstream in(path("out/sub-1/motion/sub-1_task-still_events.tsv"));
    std::ostringstream events;
    events << in.rdbuf();
    return events.str();
  };
  ASSERT_TRUE(waitUntil(kSoon, [&] {
    return countOccurrences("\tdevice_lost\t", readEvents()) > 0;
  })) << client->output();
  trace->go = 0;
  EXPECT_EQ(client->wait(kSoon), 0) << client->output();
  EXPECT_TRUE(client->says("the device does not answer: no force from now on", kSoon))
      << "the line of touch: " << client->output();
  EXPECT_EQ(trace->force_N, 0.0);
  const std::string events = readEvents();
  EXPECT_EQ(countOccurrences("\tdevice_lost\t", events), 1U) << events;
  EXPECT_EQ(countOccurrences("\tvalid\t", events), 3U) << events;
}

TEST_F(ProgramsDeviceTest, ASecondSignalDoesNotEndTheClientBeforeTheForceIsZero) {
  const auto server = startStillServer();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    const Trace trace(path("trace"));
    const auto client = touchWith(addressOf(*server), trace, "none");
    ASSERT_TRUE(waitUntil(kSoon, [&] { return trace->force_N > 0.1; })) << client->output();
    client->signal(signal);
    interrupt(*client, signal);
    EXPECT_EQ(trace->force_N, 0.0);
  }
  interrupt(*server);
}

TEST_F(ProgramsDeviceTest, AHaltSwitchesTheSignOfADeviceThatHasOne) {
  const auto server = startStillServer();
  for (const char* shape : {"", "no_sign"}) {
    SCOPED_TRACE(shape);
    const Trace trace(path(std::string("trace") + shape));
    const auto client =
        startWith({addressOf(*server), "--view", "off", "--device", "standin", "--device-option",
                   "trace=" + trace.file(), "--device-option", "fault=lost"},
                  {std::string("STANDIN_SHAPE=") + shape});
    ASSERT_TRUE(waitUntil(kSoon, [&] { return trace->force_N > 0.1; })) << client->output();
    // A late machine is a state, too.
    if (client->output().find("this machine is late") == std::string::npos) {
      EXPECT_EQ(trace->sign, 0U);
    }
    trace->go = 1;
    EXPECT_TRUE(client->says("the device does not answer: no force", kSoon)) << client->output();
    if (*shape == '\0') {
      EXPECT_TRUE(waitUntil(kSoon, [&] { return trace->sign == 1; })) << client->output();
    }
    interrupt(*client);
    if (*shape != '\0') {
      EXPECT_EQ(trace->sign, 0U);
    }
  }
  interrupt(*server);
}

TEST_F(ProgramsDeviceTest, AZeroThatTheDeviceDoesNotConfirmIsReported) {
  const auto server = startStillServer();
  const Trace trace(path("trace"));
  const auto client = touchWith(addressOf(*server), trace, "zero_fails");
  ASSERT_TRUE(waitUntil(kSoon, [&] { return trace->force_N > 0.3; })) << client->output();
  interrupt(*client);
  EXPECT_EQ(trace->force_N, 0.0) << "by the exchanges before";
  EXPECT_GE(trace->zeros, 2U);
  interrupt(*server);
}

TEST_F(ProgramsDeviceTest, AReadingWithoutDataHasNoDelay) {
  const auto server = startStillServer();
  const Trace trace(path("trace"));
  const auto client = touchWith(addressOf(*server), trace, "gaps");
  EXPECT_TRUE(waitUntil(kSoon, [&] { return trace->exchanges > 500 || !client->running(); }));
  EXPECT_TRUE(client->running()) << "a delay since the start of the machine: " << client->output();
  interrupt(*client);
  interrupt(*server);
}

TEST_F(ProgramsDeviceTest, AMeasuredDelayOverrulesASmallerOneOfTheProfile) {
  const auto server = startStillServer();
  const Trace trace(path("trace"));
  const auto client = touchWith(addressOf(*server), trace, "old");
  EXPECT_TRUE(
      client->says("ms pass from a position to its force, not 1 ms as its driver says", kSoon))
      << client->output();
  ASSERT_TRUE(waitUntil(kSoon, [&] { return trace->force_N > 0.1; })) << client->output();
  interrupt(*client);
  EXPECT_EQ(trace->force_N, 0.0);
  interrupt(*server);
}

TEST_F(ProgramsDeviceTest, ADriverThatCannotBeUsedIsRefusedWithOneLine) {
  const Trace trace(path("trace"));
  const auto refused = [&](const std::string& variable) {
    const auto client = startWith({"--view", "off", "--device", "standin", "--seconds", "1",
                                   "--device-option", "trace=" + trace.file()},
                                  {variable});
    EXPECT_EQ(client->wait(kSoon), 2) << client->output();
    return client->output();
  };
  const std::pair<const char*, const char*> shapes[] = {
      {"abi", "has version 7 of the interface, not 1"},
      {"size", "its driver structure has 16 bytes"},
      {"null", "lacks a function"},
      {"name", "another name than its file"},
      {"none", "returns no driver"}};
  for (const auto& [shape, why] : shapes)
    EXPECT_NE(refused(std::string("STANDIN_SHAPE=") + shape).find(why), std::string::npos) << shape;
  ASSERT_EQ(chmod((devices_ + "/standin.so").c_str(), 0666), 0);
  EXPECT_NE(refused("STANDIN_SHAPE=").find("others may write it; run chmod go-w"),
            std::string::npos);
  write("data/hapticast/devices/standin.so", "no library");
  ASSERT_EQ(chmod((devices_ + "/standin.so").c_str(), 0644), 0);
  EXPECT_NE(refused("STANDIN_SHAPE=").find("cannot be loaded"), std::string::npos);
}

TEST_F(ProgramsDeviceTest, OneThatDoesNotOpenEndsWithItsReason) {
  const Trace trace(path("trace"));
  const auto server = startStillServer();
  const auto client = touchWith(addressOf(*server), trace, "open_fails");
  EXPECT_EQ(client->wait(kSoon), 1) << client->output();
  EXPECT_TRUE(client->says("--device standin: it is switched off: switch it on", kSoon));
  const auto patient = touchWith(addressOf(*server), trace, "open_hangs");
  EXPECT_TRUE(waitUntil(kSoon, [&] { return trace->opened == 0 && patient->running(); }));
  patient->signal(SIGTERM);
  EXPECT_TRUE(patient->wait(kSoon).has_value()) << "a device that opens for minutes can be ended";
  interrupt(*server);
}

TEST_F(ProgramsDeviceTest, TheListAsksEachDriverForAtMostTwoSeconds) {
  const auto list = [&](const std::string& fault) {
    const auto client = startWith({"--list-devices", "--device-option", "fault=" + fault});
    EXPECT_EQ(client->wait(kSoon), 0) << client->output();
    return client->output();
  };
  EXPECT_NE(list("none").find("standin: a driver of its own; serial number S1"), std::string::npos);
  EXPECT_NE(list("busy").find("; found, but it is busy"), std::string::npos);
  EXPECT_NE(list("list_hangs").find("its driver did not answer within two seconds"),
            std::string::npos);
  const std::string failed = list("list_fails");
  EXPECT_NE(failed.find("the bus ?[31mis? off"), std::string::npos) << failed;
  EXPECT_LE(countOccurrences("serial number S1", list("crowd")), 32U);
}

/// Returns the C code of client/device/drivers.md.
std::string readExample() {
  std::ifstream in(std::string(HAPTICAST_TESTS) + "/../client/device/drivers.md");
  std::ostringstream whole;
  whole << in.rdbuf();
  const std::string text = whole.str();
  const std::size_t begin = text.find("```c\n");
  if (begin == std::string::npos) return "";
  return text.substr(begin + 5, text.find("```", begin + 5) - begin - 5);
}

TEST_F(ProgramsDeviceTest, TheExampleOfThePageWorksAsPrinted) {
  const std::string code = readExample();
  ASSERT_FALSE(code.empty());
  EXPECT_LE(std::count(code.begin(), code.end(), '\n'), 45);
  const std::string source = write("example.c", code);
  const std::string library = path("example.so");
  const auto compiler = start(
      "/usr/bin/env", {"cc", "-std=c99", "-pedantic", "-Wall", "-Werror", "-shared", "-fPIC", "-I",
                       std::string(HAPTICAST_TESTS) + "/../client/device", source, "-o", library});
  ASSERT_EQ(compiler->wait(kSoon), 0) << compiler->output();
  install(library, "example");
  const auto server = startStillServer();
  const std::string summary = path("summary.json");
  const auto client = startWith({addressOf(*server), "--view", "off", "--device", "example",
                                 "--log", path("log.csv"), "--summary", summary});
  EXPECT_TRUE(touchesFor(0)) << client->output();
  interrupt(*client);
  std::ifstream in(summary);
  std::ostringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str().find("\"contact_ticks\": 0,"), std::string::npos);
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
