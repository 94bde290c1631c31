// SPDX-License-Identifier: MIT
#include "server/settings/command_line.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "common/build_options.hpp"
#include "common/cli/parse.hpp"
#include "common/cli/program_flags.hpp"
#include "common/codec/height_codec.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "tests/unit/command_line_probe.hpp"

namespace hapticast::server {
namespace {

using Probe = testing_support::CommandLineProbe<Settings, commandLine, kSubcommandChoice>;

TEST(ServerSettings, Defaults) {
  const Probe run({"--source", "synthetic:still"});
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  EXPECT_EQ(run.settings.source, "synthetic:still");
  EXPECT_EQ(run.settings.fps, 0.0);
  EXPECT_EQ(run.settings.frames, 0U);
  EXPECT_EQ(run.settings.listen, (Endpoint{"::", 7447}));
  EXPECT_EQ(run.settings.max_clients, 64U);
  EXPECT_EQ(run.settings.http, std::nullopt);
  EXPECT_EQ(run.settings.announce, "");
  EXPECT_TRUE(run.settings.datagrams);
  EXPECT_EQ(run.settings.multicast, std::nullopt);
  EXPECT_FALSE(run.settings.loop || run.settings.quiet || run.settings.vision.stretch);
  EXPECT_EQ(run.settings.vision.segment, SegmentMode::kAuto);
  EXPECT_EQ(run.settings.vision.motion, MotionMode::kAuto);
  EXPECT_EQ(run.settings.vision.method, Method::kHapticast);
  EXPECT_EQ(run.settings.vision.mass_kg, std::nullopt);
  EXPECT_FALSE(run.settings.vision.depth_range.has_value());
  EXPECT_EQ(run.settings.layout, VideoLayout{});
}

void expectAll(const Settings& settings) {
  EXPECT_EQ(settings.source, "my clip");
  EXPECT_EQ(settings.fps, 60.0);
  EXPECT_TRUE(settings.loop);
  EXPECT_EQ(settings.frames, 1000U);
  EXPECT_EQ(settings.listen, (Endpoint{"127.0.0.1", 0}));
  EXPECT_EQ(settings.max_clients, 3U);
  EXPECT_EQ(settings.http, (Endpoint{"127.0.0.1", 9464}));
  EXPECT_EQ(settings.host_names, (std::vector<std::string>{"figures.example", "Lab_1.local"}));
  EXPECT_FALSE(settings.datagrams);
  EXPECT_EQ(settings.multicast, (MulticastChoice{{"ff12::7", 7448}, "eth0"}));
  EXPECT_EQ(settings.multicast_hops, 3U);
  EXPECT_TRUE(settings.quiet);
  EXPECT_TRUE(settings.wait_for_viewer);
  const VisionSettings& vision = settings.vision;
  EXPECT_EQ(vision.object_points,
            (std::vector<AuthorPoint>{{{505.0, 330.0}, 0.0}, {{10.0, 20.0}, 2.5}}));
  EXPECT_EQ(vision.not_points, (std::vector<AuthorPoint>{{{300.0, 400.0}, 0.0}}));
  EXPECT_EQ(vision.segment, SegmentMode::kBand);
  ASSERT_TRUE(vision.depth_range.has_value());
  EXPECT_EQ(vision.depth_range->near_mm, 500.0);
  EXPECT_EQ(vision.depth_range->far_mm, 1500.0);
  ASSERT_TRUE(vision.map_range.has_value());
  EXPECT_EQ(vision.map_range->near_mm, 600.0);
  EXPECT_EQ(settings.signing_key_file, "origin.pem");
  EXPECT_FALSE(settings.page);
  EXPECT_EQ(vision.map_range->far_mm, 650.0);
  EXPECT_EQ(vision.fov_deg, 70.0);
  EXPECT_TRUE(vision.stretch);
  EXPECT_EQ(vision.motion, MotionMode::kLk);
  EXPECT_EQ(vision.material.stiffness_N_mm, 0.4);
  EXPECT_EQ(vision.material.static_friction, 0.5);
  EXPECT_EQ(vision.material.dynamic_friction, 0.3);
  EXPECT_EQ(vision.material.damping_Ns_m, 2.5);
  EXPECT_EQ(vision.material.texture_K_mm, 1.5);
  EXPECT_EQ(vision.mass_kg, 0.25);
  EXPECT_EQ(vision.method, Method::kThesis);
  EXPECT_EQ(settings.layout.depth_unit_mm, 0.2);
  EXPECT_EQ(settings.layout.color_glob, "c_*.png");
  EXPECT_EQ(settings.layout.depth_glob, "d_*.png");
}

const std::vector<std::pair<std::string, std::string>> kAll = {
    {"source", "my clip"},
    {"fps", "60"},
    {"loop", "true"},
    {"frames", "1000"},
    {"quiet", "true"},
    {"listen", "127.0.0.1:0"},
    {"max-clients", "3"},
    {"http", "9464"},
    {"page", "off"},
    {"host-name", "figures.example"},
    {"host-name", "Lab_1.local"},
    {"object", "505,330"},
    {"not", "300,400"},
    {"object", "10,20@2.5"},
    {"segment", "band"},
    {"depth-range", "500,1500"},
    {"map-range", "600,650"},
    {"stretch", "true"},
    {"motion", "lk"},
    {"stiffness", "0.4"},
    {"mass", "0.25"},
    {"method", "thesis"},
    {"friction", "0.5,0.3"},
    {"damping", "2.5"},
    {"texture-depth", "1.5"},
    {"fov", "70"},
    {"wait-for-viewer", "true"},
    {"transport", "tcp"},
    {"multicast", "[ff12::7]:7448@eth0"},
    {"multicast-ttl", "3"},
    {"signing-key", "origin.pem"},
    {"depth-unit", "0.2"},
    {"color", "c_*.png"},
    {"depth", "d_*.png"},
};

TEST(ServerSettings, EveryFlagAndEveryKeyOfAConfigFile) {
  for (const Probe& run : {Probe::withFlags(kAll), Probe::withConfig(kAll)}) {
    ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
    expectAll(run.settings);
  }
}

TEST(ServerSettings, ANameForTheLan) {
  const auto named = [](const std::string& name) {
    return Probe({"--source", "synthetic:still", "--announce", name});
  };
  if (!kHasDiscovery) {
    named("Ball").expectErrorWith(
        {"--announce", "this build has no Avahi, so it cannot announce or find servers"});
    return;
  }
  EXPECT_EQ(named("Küche \xF0\x9F\x8F\x80").settings.announce, "Küche \xF0\x9F\x8F\x80");
  for (const std::string& wrong : {std::string(), std::string(64, 'x'), std::string("\x1b[2J")}) {
    EXPECT_EQ(named(wrong).exit_code, 2) << wrong.size();
    named(wrong).expectErrorWith({"--announce", "1 to 63 bytes"});
  }
}

TEST(ServerSettings, ReportsAWrongValueWithFlagValueAndAllowedRange) {
  const std::vector<std::array<std::string, 3>> wrong = {
      {"--fps", "nan", "1 to 240"},
      {"--fps", "0.5", "1 to 240"},
      {"--frames", "-1", ""},
      {"--frames", "0", ""},
      {"--frames", "1e30", ""},
      {"--frames", "many", ""},
      {"--listen", "a:b:80", "[ADDR:]PORT"},
      {"--http", "0.0.0.0", "[ADDR:]PORT"},
      {"--http", "a:b:80", "[ADDR:]PORT"},
      {"--http", "65536", "0..65535"},
      {"--host-name", "figures.example:80", "a host name without a port"},
      {"--host-name", "a b", "a host name without a port"},
      {"--host-name", "*", "a host name without a port"},
      {"--max-clients", "0", "1"},
      {"--max-clients", "10001", "10000"},
      {"--transport", "quic", "tcp|udp"},
      {"--multicast", "239.1.2.3", "GROUP:PORT[@INTERFACE]"},
      {"--multicast", ":7448", "GROUP:PORT[@INTERFACE]"},
      {"--multicast", "239.1.2.3:0", "GROUP:PORT[@INTERFACE]"},
      {"--multicast", "239.1.2.3:7448@", "GROUP:PORT[@INTERFACE]"},
      {"--multicast-ttl", "0", "1 to 255"},
      {"--object", "12", "U,V[#N|@SECONDS] in px"},
      {"--object", "nan,1", "U,V[#N|@SECONDS] in px"},
      {"--object", "1,2@", "U,V[#N|@SECONDS] in px"},
      {"--object", "@1", "U,V[#N|@SECONDS] in px"},
      {"--object", "1@2,3", "U,V[#N|@SECONDS] in px"},
      {"--object", "1,2@3@4", "U,V[#N|@SECONDS] in px"},
      {"--object", "1,2@-0.5", "U,V[#N|@SECONDS] in px"},
      {"--object", "1,2@nan", "U,V[#N|@SECONDS] in px"},
      {"--object", "1,2@soon", "U,V[#N|@SECONDS] in px"},
      {"--not", "1,2@1e7", "U,V[@SECONDS] in px"},
      {"--not", "1,2,3", "U,V[@SECONDS] in px"},
      {"--preview", "clip.jpg", "FILE.png or a folder"},
      {"--segment", "magic", "auto|band|edges|source"},
      {"--depth-range", "900,500", "NEAR,FAR in mm"},
      {"--map-range", "650,600", "NEAR,FAR in mm"},
      {"--depth-range", "-1,500", "NEAR,FAR in mm"},
      {"--depth-range", "0,1e300", "NEAR,FAR in mm"},
      {"--fov", "171", "10 to 170"},
      {"--fov", "wide", "10 to 170"},
      {"--motion", "rgb", "auto|depth|lk|none"},
      {"--stiffness", "inf", "0.01 to 10"},
      {"--friction", "0.3", "0 <= D <= S <= 1.5"},
      {"--friction", "0.3,0.5", "0 <= D <= S <= 1.5"},
      {"--friction", "1.6,1", "0 <= D <= S <= 1.5"},
      {"--friction", "0.3,-0.1", "0 <= D <= S <= 1.5"},
      {"--friction", "nan,nan", "0 <= D <= S <= 1.5"},
      {"--mass", "nan", "0.001 to 100"},
      {"--method", "best", "hapticast|thesis"}};
  for (const auto& [flag, value, allowed] : wrong) {
    const Probe run({"--source", "synthetic:still", flag, value});
    EXPECT_EQ(run.exit_code, 2) << flag << " " << value;
    run.expectErrorWith({flag, value, allowed});
  }
}

TEST(ServerSettings, ProgramsOfTheUserAndCandidates) {
  const Probe run({"--source", "a.mp4", "--depth-from", "estimate --fast", "--depth-cache", "kept",
                   "--depth-cache-limit", "2.5", "--mask-from", "segment", "--object", "5,6#2",
                   "--object", "7,8@1.5"});
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  EXPECT_EQ(run.settings.child, (ChildSettings{"estimate --fast", "kept", 2.5, "segment"}));
  EXPECT_EQ(run.settings.vision.object_points,
            (std::vector<AuthorPoint>{{{5, 6}, 0.0, 0, 2}, {{7, 8}, 1.5, 0, 1}}));
  const Probe config =
      Probe::withConfig({{"source", "a.mp4"}, {"depth-from", "estimate"}, {"object", "5,6#2"}});
  EXPECT_EQ(config.settings.child.depth_command, "estimate");
  EXPECT_EQ(config.settings.vision.object_points, (std::vector<AuthorPoint>{{{5, 6}, 0.0, 0, 2}}));
}

TEST(ServerSettings, ReportsMissingAndUnknownFlags) {
  const Probe none({});
  EXPECT_EQ(none.exit_code, 2);
  none.expectErrorWith({"--source"});
  const Probe unknown({"--source", "a", "--speed", "1"});
  EXPECT_EQ(unknown.exit_code, 2);
  unknown.expectErrorWith({"--speed"});
}

TEST(ServerSettings, RefusesEachFlagOfTheClient) {
  for (const std::string_view flag : ownFlags(kClientProgram)) {
    const std::string word = "--" + std::string(flag);
    const Probe run({"--source", "synthetic:still", word, "1"});
    EXPECT_EQ(run.exit_code, 2) << word;
    run.expectErrorWith({fmt::format("'{0}' '1'; {0} is a flag of hapticast-client", word)});
  }
  const std::string help = Probe::printHelp();
  for (const std::string_view flag : ownFlags(kServerProgram))
    EXPECT_NE(help.find("--" + std::string(flag)), std::string::npos) << flag;
}

TEST(ServerSettings, EachSubcommandHasItsFlags) {
  const auto parse = [](const std::vector<std::string>& arguments) {
    const Probe run(arguments);
    EXPECT_EQ(run.exit_code, std::nullopt) << arguments[0] << ": " << run.error;
    return run.settings;
  };
  EXPECT_EQ(parse({"serve", "synthetic:still"}).source, "synthetic:still");
  Settings settings = parse({"preview", "synthetic:still", "-o", "a.png", "--object", "1,2"});
  EXPECT_EQ(settings.command, Command::kPreview);
  EXPECT_EQ(settings.preview, "a.png");
  settings = parse({"bake", "synthetic:still", "-o", "site/", "--fov", "70", "--quiet"});
  EXPECT_EQ(settings.command, Command::kBake);
  EXPECT_EQ(settings.bake.out, "site/");
  EXPECT_EQ(settings.bake.flags, " --fov 70");
  settings = parse({"relay", "nats://host/lab", "--page", "off"});
  EXPECT_EQ(settings.command, Command::kRelay);
  EXPECT_EQ(settings.source, "nats://host/lab");
}

TEST(ServerSettings, AFlagOfEarlierVersionsChoosesItsSubcommand) {
  EXPECT_EQ(Probe({"--source", "synthetic:still", "--preview", "a.png"}).settings.command,
            Command::kPreview);
  const Probe edge({"--page", "off", "--source", "nats://host/lab"});
  EXPECT_EQ(edge.exit_code, std::nullopt) << edge.error;
  EXPECT_EQ(edge.settings.command, Command::kRelay);
  const Probe config = Probe::withConfig({{"source", "nats://host/lab"}, {"loop", "true"}});
  EXPECT_EQ(config.exit_code, std::nullopt) << config.error;
  EXPECT_EQ(config.settings.command, Command::kRelay);
  EXPECT_FALSE(config.settings.loop) << "a key of serve";
  const Probe both =
      Probe::withConfig({{"source", "nats://host/lab"}}, {"--source", "synthetic:still"});
  EXPECT_EQ(both.settings.command, Command::kServe) << "the flag wins over the file";
  EXPECT_EQ(Probe::withConfig({{"source", "nats://host/lab"}}, {"a.mkv"}).settings.command,
            Command::kServe)
      << "and so does a source without a flag";
  EXPECT_EQ(Probe({"nats://host/lab"}).settings.command, Command::kRelay);
}

TEST(ServerSettings, RefusesAFlagOfAnotherSubcommandWithItsName) {
  Probe({"bake", "synthetic:still", "-o", "a.mcap", "--max-clients", "3"})
      .expectErrorWith({"'--max-clients'", "--max-clients is a flag of hapticast-server serve"});
  Probe({"serve", "nats://host/lab"}).expectErrorWith({"use hapticast-server relay CHANNEL"});
  Probe({"relay", "synthetic:still"}).expectErrorWith({"is not nats://"});
}

TEST(ServerSettings, AnAddressAndCommonSlipsAreReported) {
  for (const char* address : {"192.168.1.5", "192.168.1.5:7447", "7500", "localhost"})
    Probe({address}).expectErrorWith({address, "is --listen missing in front of it?"});
  Probe({"help"}).expectErrorWith({"did you mean --help?"});
  Probe({"-v"}).expectErrorWith({"did you mean --version?"});
}

TEST(ServerSettings, HelpAndVersionEndWithZero) {
  const Probe help({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* name : {"serve", "preview", "bake", "relay", "--quiet"})
    EXPECT_NE(help.output.find(name), std::string::npos) << name;
  const Probe serve({"serve", "--help"});
  EXPECT_EQ(serve.exit_code, 0);
  for (const auto& [key, value] : kAll)
    EXPECT_TRUE(key == "quiet" || serve.output.find("--" + key) != std::string::npos) << key;
  const Probe version({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.output.find("hapticast-server 0."), 0U) << version.output;
  EXPECT_NE(version.output.find("optional packages"), std::string::npos) << version.output;
}

TEST(ServerSettings, APrintedConfigFileHasEachFlagAndItsDefault) {
  Probe::expectConfigOfDefaults({"--source", "synthetic:still"});
  const Probe config({"--print-config"});
  EXPECT_EQ(config.exit_code, 0) << "without --source, too";
  for (const char* line : {"\n#source =\n", "\n#listen = [::]:7447\n", "\n#transport = udp\n",
                           "\n#max-clients = 64\n", "\n#fps =\n", "\n#loop = false\n"})
    EXPECT_NE(config.output.find(line), std::string::npos) << line << config.output;
  for (const std::string_view flag : ownFlags(kServerProgram))
    EXPECT_NE(config.output.find(fmt::format("\n#{} =", flag)), std::string::npos) << flag;
}

TEST(ServerSettings, TheForceBudgetSetsTheErrorOfHeights) {
  VisionSettings vision;
  EXPECT_DOUBLE_EQ(computeHeightError_mm(vision), kDefaultHeightError_mm);
  vision.material.stiffness_N_mm = 2.0;
  EXPECT_DOUBLE_EQ(computeHeightError_mm(vision), 0.25 * kDefaultHeightError_mm);
  vision.plan.error_budget_N *= 2.0;
  EXPECT_DOUBLE_EQ(computeHeightError_mm(vision), 0.5 * kDefaultHeightError_mm);
  vision.plan.error_budget_N = 1.0;
  EXPECT_DOUBLE_EQ(computeHeightError_mm(vision), 0.25);
}

}  // namespace
}  // namespace hapticast::server
