// SPDX-License-Identifier: MIT
#include "client/settings/command_line.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/build_options.hpp"
#include "common/cli/parse.hpp"
#include "common/cli/program_flags.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/command_line_probe.hpp"

namespace hapticast::client {
namespace {

using Probe = testing_support::CommandLineProbe<Settings, commandLine, kSubcommandChoice>;

TEST(ClientSettings, Defaults) {
  const Probe run({});
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  EXPECT_EQ(run.settings.server, (Endpoint{"localhost", 7447}));
  EXPECT_EQ(run.settings.announced, "");
  EXPECT_FALSE(run.settings.server_given);
  EXPECT_EQ(run.settings.command, Command::kTouch);
  EXPECT_EQ(run.settings.device, "auto");
  EXPECT_EQ(run.settings.profile, "");
  EXPECT_TRUE(run.settings.device_options.empty());
  EXPECT_FALSE(run.settings.list_devices);
  EXPECT_FALSE(run.settings.rearm);
  EXPECT_FALSE(run.settings.sound);
  EXPECT_EQ(run.settings.stiffness_limit_N_mm, 0.0);
  EXPECT_EQ(run.settings.fault_folder, "");
  EXPECT_EQ(run.settings.delivery.best, Transport::kDatagrams);
  EXPECT_EQ(run.settings.delivery.copies, 0U);
  EXPECT_EQ(run.settings.delivery.interface_name, "");
  EXPECT_EQ(run.settings.max_delay_ms, 2000.0);
  EXPECT_EQ(run.settings.surface, SurfaceKind::kProxy);
  EXPECT_EQ(run.settings.hand, "press");
  EXPECT_FALSE(run.settings.hand_given);
  EXPECT_EQ(run.settings.view, ViewChoice::kAuto);
  EXPECT_EQ(run.settings.forces, Forces::kBoth);
  EXPECT_EQ(run.settings.seconds, 0.0);
  EXPECT_EQ(run.settings.method, Method::kHapticast);
  EXPECT_FALSE(run.settings.quiet);
  EXPECT_TRUE(run.settings.log_file.empty() && run.settings.summary_file.empty() &&
              run.settings.screenshot_file.empty() && run.settings.film_file.empty());
}

TEST(ClientSettings, RefusesEachFlagOfTheServer) {
  for (const std::string_view flag : ownFlags(kServerProgram)) {
    const std::string word = "--" + std::string(flag);
    const Probe run({word + "=1"});
    EXPECT_EQ(run.exit_code, 2) << word;
    run.expectErrorWith({fmt::format("'{0}=1'; {0} is a flag of hapticast-server", word)});
  }
  const std::string help = Probe::printHelp();
  for (const std::string_view flag : ownFlags(kClientProgram)) {
    const bool optional = flag.starts_with("falcon") || flag == "sound";
    EXPECT_TRUE(optional || help.find("--" + std::string(flag)) != std::string::npos) << flag;
  }
}

TEST(ClientSettings, EachOutputNeedsAFileOfItsOwn) {
  const TempFolder folder;
  const auto complaintOf = [](const Settings& settings) -> std::string {
    try {
      requireDistinctOutputs(settings);
      return "";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  Settings settings;
  settings.log_file = (folder / "a").string();
  settings.summary_file = (folder / "b").string();
  EXPECT_EQ(complaintOf(settings), "");
  settings.summary_file = (folder / "." / "a").string();
  const std::string same =
      "--summary " + settings.summary_file + ": is the file of --log, too; name another file";
  EXPECT_EQ(complaintOf(settings), same) << "neither file exists yet";
  folder.write("a", "x");
  EXPECT_EQ(complaintOf(settings), same);
  settings.film_file = settings.summary_file;
  settings.summary_file = "";
  EXPECT_EQ(complaintOf(settings).substr(0, 7), "--film ");
  settings.log_file = settings.film_file = "/dev/null";
  EXPECT_EQ(complaintOf(settings), "");
}

void expectAll(const Settings& settings) {
  EXPECT_EQ(settings.server, (Endpoint{"::1", 99}));
  EXPECT_TRUE(settings.server_given);
  EXPECT_EQ(settings.origin_keys, std::vector<OriginKey>{{}});
  EXPECT_EQ(settings.command, Command::kTouch);
  EXPECT_EQ(settings.device, "virtual");
  EXPECT_EQ(settings.profile, "falcon");
  EXPECT_EQ(settings.hand, "slide");
  EXPECT_TRUE(settings.hand_given);
  EXPECT_EQ(settings.view, ViewChoice::kOff);
  EXPECT_EQ(settings.forces, Forces::kStatic);
  EXPECT_EQ(settings.delivery.best, Transport::kTcp);
  EXPECT_EQ(settings.delivery.copies, 3U);
  EXPECT_EQ(settings.delivery.interface_name, "lo");
  EXPECT_EQ(settings.max_delay_ms, 250.0);
  EXPECT_TRUE(settings.fullscreen);
  EXPECT_EQ(settings.surface, SurfaceKind::kPerturbed);
  EXPECT_EQ(settings.method, Method::kThesis);
  EXPECT_EQ(settings.log_file, "a.csv");
  EXPECT_EQ(settings.summary_file, "b.json");
  EXPECT_EQ(settings.screenshot_file, "c.png");
  EXPECT_EQ(settings.film_file, "c.mp4");
  EXPECT_EQ(settings.sound, kHasSound);
  EXPECT_EQ(settings.seconds, 2.5);
  EXPECT_EQ(settings.fault_folder, "d");
  EXPECT_TRUE(settings.rearm);
  EXPECT_EQ(settings.stiffness_limit_N_mm, 2.5);
  EXPECT_TRUE(settings.quiet);
  const bool falcon = kHasFalcon;
  std::map<std::string, std::string> options{
      {"falcon.firmware", "f.bin"}, {"falcon.gain", "4000"}, {"falcon.serial", "A7"}};
  if (!falcon) options.clear();
  EXPECT_EQ(settings.device_options, options);
}

std::vector<std::pair<std::string, std::string>> everyFlag() {
  std::vector<std::pair<std::string, std::string>> flags = {
      {"server", "[::1]:99"}, {"device", "virtual"},
      {"profile", "falcon"},  {"view", "off"},
      {"forces", "static"},   {"hand", "slide"},
      {"transport", "tcp"},   {"surface", "perturbed"},
      {"method", "thesis"},   {"log", "a.csv"},
      {"summary", "b.json"},  {"seconds", "2.5"},
      {"quiet", "true"},      {"rearm", "true"},
      {"fault-dir", "d"},     {"stiffness-limit", "2.5"},
      {"redundancy", "3"},    {"interface", "lo"},
      {"max-delay", "250"},   {"fullscreen", "true"},
      {"origin-key", "first"}};
  if (kHasFalcon) {
    flags.emplace_back("falcon-firmware", "f.bin");
    flags.emplace_back("falcon-serial", "A7");
    flags.emplace_back("falcon-gain", "4000");
  }
  flags.emplace_back("screenshot", "c.png");
  flags.emplace_back("film", "c.mp4");
  if (kHasSound) flags.emplace_back("sound", "true");
  return flags;
}
const auto kAll = everyFlag();

TEST(ClientSettings, EveryFlagAndEveryKeyOfAConfigFile) {
  for (const Probe& run : {Probe::withFlags(kAll), Probe::withConfig(kAll)}) {
    ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
    expectAll(run.settings);
  }
}

TEST(ClientSettings, AFlagWinsOverTheConfigFile) {
  const Probe run = Probe::withConfig(kAll, {"--hand", "follow"});
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  EXPECT_EQ(run.settings.hand, "follow");
  EXPECT_EQ(run.settings.profile, "falcon");
}

TEST(ClientSettings, ReportsAWrongValueWithFlagValueAndAllowedRange) {
  const std::vector<std::array<std::string, 3>> wrong = {
      {"--device", "spoon", "mouse|touch|virtual"},
      {"--device", "Omni", "did you mean touch?"},
      {"--transport", "upd", "multicast|tcp|udp"},
      {"--redundancy", "5", "auto or 1..4"},
      {"--redundancy", "some", "auto or 1..4"},
      {"--origin-key", "First", "64 hex digits"},
      {"--origin-key", "0123", "64 hex digits"},
      {"--surface", "flat", "normal|perturbed"},
      {"--method", "best", "hapticast|thesis"},
      {"--seconds", "nan", "0.001 to 1000000000"},
      {"--seconds", "0", "0.001 to 1000000000"},
      {"--seconds", "1e300", "0.001 to 1000000000"},
      {"server", "host:99999", "HOST[:PORT]"},
      {"server", "host:0", "port 1..65535"},
      {"server", "a b", "HOST[:PORT]"}};
  for (const auto& [flag, value, allowed] : wrong) {
    std::vector<std::string> arguments;
    if (flag != "server") arguments.push_back(flag);
    arguments.push_back(value);
    const Probe run(arguments);
    EXPECT_EQ(run.exit_code, 2) << flag << " " << value;
    run.expectErrorWith({flag, value, allowed});
  }
}

TEST(ClientSettings, SeveralOriginKeys) {
  const KeyBytes key = SigningKey(KeyBytes{7}).verifyingKey();
  const Probe run({"--origin-key", toHex(key), "--origin-key", "first"});
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  EXPECT_EQ(run.settings.origin_keys, (std::vector<OriginKey>{{key}, {}}));
  EXPECT_TRUE(Probe({}).settings.origin_keys.empty());
}

TEST(ClientSettings, AServerThatIsAnnounced) {
  const Probe run({"mdns:Living room"});
  if (!kHasDiscovery) {
    run.expectErrorWith(
        {"server", "this build has no Avahi, so it cannot announce or find servers"});
    return;
  }
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  EXPECT_EQ(run.settings.announced, "Living room");
  EXPECT_TRUE(run.settings.server_given);
  EXPECT_EQ(Probe({"mdns:7447"}).settings.announced, "7447") << "never a port of a host";
  EXPECT_EQ(Probe({"[mdns]:7447"}).settings.server, (Endpoint{"mdns", 7447}));
  EXPECT_EQ(Probe({"mdns:two\nlines"}).exit_code, 2);
}

TEST(ClientSettings, EachSubcommandHasItsFlags) {
  const auto parse = [](const std::vector<std::string>& arguments) {
    const Probe run(arguments);
    EXPECT_EQ(run.exit_code, std::nullopt) << arguments[0] << ": " << run.error;
    return run.settings;
  };
  EXPECT_EQ(parse({"touch", "list"}).server.host, "list") << "a host with a subcommand's name";
  Settings settings = parse({"replay", "run.mcap", "--stiffness", "0.5"});
  EXPECT_EQ(settings.command, Command::kReplay);
  EXPECT_EQ(settings.replay_file, "run.mcap");
  settings = parse({"study", "s.json", "host:99", "--subject", "1", "--out", "d"});
  EXPECT_EQ(settings.command, Command::kStudy);
  EXPECT_EQ(settings.study.file, "s.json");
  EXPECT_EQ(settings.server, (Endpoint{"host", 99}));
  settings = parse({"check"});
  EXPECT_EQ(settings.command, Command::kCheck);
  EXPECT_EQ(settings.check_device, "auto");
  EXPECT_EQ(parse({"check", "virtual"}).check_device, "virtual");
  EXPECT_EQ(parse({"check", "--calibrate", "200"}).calibration_g, 200.0);
  settings = parse({"list", "--devices"});
  EXPECT_EQ(settings.command, Command::kList);
  EXPECT_TRUE(settings.list_devices);
  settings = parse({"control", "pause", "host", "--token-file", "t"});
  EXPECT_EQ(settings.command, Command::kControl);
  EXPECT_EQ(settings.control->paused, true);
  EXPECT_EQ(settings.server.host, "host");
}

TEST(ClientSettings, AFlagOfEarlierVersionsChoosesItsSubcommand) {
  const auto choose = [](const std::vector<std::string>& arguments) {
    const Probe run(arguments);
    EXPECT_EQ(run.exit_code, std::nullopt) << arguments[0] << ": " << run.error;
    return run.settings.command;
  };
  EXPECT_EQ(choose({"--log", "a.csv", "--replay", "run.mcap"}), Command::kReplay);
  EXPECT_EQ(choose({"--replay=run.mcap"}), Command::kReplay);
  EXPECT_EQ(choose({"host", "--subject", "1", "--study", "s.json", "--out", "d"}), Command::kStudy);
  EXPECT_EQ(choose({"--check-device", "virtual"}), Command::kCheck);
  EXPECT_EQ(choose({"--falcon-calibrate", "200"}), Command::kCheck);
  EXPECT_EQ(choose({"--device-option", "a=b", "--list-devices"}), Command::kList);
  EXPECT_EQ(choose({"host", "--token-file", "t", "--control", "play"}), Command::kControl);
  if (kHasDiscovery) {
    EXPECT_EQ(choose({"--list"}), Command::kList);
  }
  EXPECT_EQ(choose({"--list-devices", "--quiet"}), Command::kList);
  EXPECT_EQ(choose({"--quiet", "check", "virtual"}), Command::kCheck) << "a flag of the program";
  EXPECT_EQ(Probe::withConfig({{"list-devices", "off"}}).settings.command, Command::kTouch);
  EXPECT_EQ(Probe::withConfig({{"list-devices", "on"}}).settings.command, Command::kList);
}

TEST(ClientSettings, BlamesTheConfigFileForItsOwnMistakesOnly) {
  const auto blamed = [](const std::vector<std::string>& arguments) {
    const Probe run = Probe::withConfig({{"quiet", "true"}}, arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments[0];
    return run.error.find("program.conf") != std::string::npos;
  };
  EXPECT_FALSE(blamed({"replay", "run.txt"}));
  EXPECT_FALSE(blamed({"check", "omni"}));
  EXPECT_FALSE(blamed({"control", "foo"}));
  EXPECT_FALSE(blamed({"--falcon-calibrate", "10"}));
  const Probe own = Probe::withConfig({{"seconds", "never"}});
  own.expectErrorWith({"program.conf", "--seconds"});
}

TEST(ClientSettings, OneConfigFileServesAllSubcommands) {
  const Probe replay = Probe::withConfig({{"hand", "slide"}, {"log", "a.csv"}, {"quiet", "true"}},
                                         {"replay", "run.mcap"});
  ASSERT_EQ(replay.exit_code, std::nullopt) << replay.error;
  EXPECT_EQ(replay.settings.hand, "press") << "a key of touch";
  EXPECT_EQ(replay.settings.log_file, "a.csv");
  EXPECT_TRUE(replay.settings.quiet);
  EXPECT_EQ(Probe::withConfig({{"replay", "run.mcap"}}).settings.command, Command::kReplay);
}

TEST(ClientSettings, RefusesAFlagOfAnotherSubcommandWithItsName) {
  const Probe run({"replay", "run.mcap", "--hand", "press"});
  EXPECT_EQ(run.exit_code, 2);
  run.expectErrorWith({"'--hand'", "--hand is a flag of hapticast-client touch"});
}

TEST(ClientSettings, RefusesUnknownFlagsWithAMessage) {
  const Probe unknown({"--forse", "1"});
  EXPECT_EQ(unknown.exit_code, 2);
  unknown.expectErrorWith({"--forse"});
}

TEST(ClientSettings, APrintedConfigFileHasEachFlagAndItsDefault) {
  Probe::expectConfigOfDefaults({});
  const Probe config({"--print-config"});
  EXPECT_EQ(config.exit_code, 0);
  for (const char* line : {"\n#server =\n", "\n#device = auto\n", "\n#surface = proxy\n"})
    EXPECT_NE(config.output.find(line), std::string::npos) << line << config.output;
  EXPECT_EQ(config.output.find("\n#falcon-gain = 3500\n") != std::string::npos, kHasFalcon);
}

TEST(ClientSettings, HelpAndVersionEndWithZero) {
  const Probe touch({"touch", "--help"});
  EXPECT_EQ(touch.exit_code, 0);
  for (const auto& [key, value] : kAll)
    EXPECT_TRUE(key == "quiet" || touch.output.find(key) != std::string::npos) << key;
  const Probe help({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  const Probe version({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.output.find("hapticast-client 0."), 0U) << version.output;
  for (const char* fact :
       {"views: screenshot film", "devices: virtual", "transports: multicast tcp udp",
        kHasDiscovery ? "discovery: Avahi" : "discovery: none", "libusb 1.0 (", "SDL2 (",
        "SDL2 + Dear ImGui (", "Avahi ("}) {
    EXPECT_NE(version.output.find(fact), std::string::npos) << fact << " in: " << version.output;
    EXPECT_NE(help.output.find(fact), std::string::npos) << fact << " in: " << help.output;
  }
}

}  // namespace
}  // namespace hapticast::client
