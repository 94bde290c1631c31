// SPDX-License-Identifier: MIT
// A program's command line, parsed as main() does it, with all it says.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::testing_support {

template <class Settings, auto kCommandLine, const SubcommandChoice& kChoice>
struct CommandLineProbe {
  Settings settings;
  std::optional<int> exit_code;
  std::string output;
  std::string error;

  explicit CommandLineProbe(const std::vector<std::string>& arguments) {
    std::vector<const char*> argv{"program"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    const auto app = kCommandLine(settings);
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    exit_code = parseCommandLine(*app, static_cast<int>(argv.size()), argv.data(), kChoice);
    output = ::testing::internal::GetCapturedStdout();
    error = ::testing::internal::GetCapturedStderr();
  }

  /// These keys as flags; the value "true": a switch; the key "server": an argument by itself.
  static CommandLineProbe withFlags(const std::vector<std::pair<std::string, std::string>>& keys) {
    std::vector<std::string> arguments;
    for (const auto& [key, value] : keys) {
      if (key != "server") arguments.push_back("--" + key);
      if (value != "true") arguments.push_back(value);
    }
    return CommandLineProbe(arguments);
  }
  /// A config file of these keys, and flags beside it.
  static CommandLineProbe withConfig(const std::vector<std::pair<std::string, std::string>>& keys,
                                     std::vector<std::string> arguments = {}) {
    const TempFolder folder;
    std::string lines;
    for (const auto& [key, value] : keys)
      lines.append(key).append(" = ").append(value).append("\n");
    arguments.insert(arguments.end(), {"--config", folder.write("program.conf", lines)});
    return CommandLineProbe(arguments);
  }

  /// Returns the help of the program and of each subcommand.
  static std::string printHelp() {
    std::string help = CommandLineProbe({"--help"}).output;
    Settings settings;
    const auto app = kCommandLine(settings);
    for (const CLI::App* const each : app->get_subcommands({}))
      help += CommandLineProbe({each->get_name(), "--help"}).output;
    return help;
  }

  /// --print-config has each flag of --help once, and its defaults are those of the program: set
  /// in a config file, they change nothing. `required`: arguments without which nothing starts.
  static void expectConfigOfDefaults(const std::vector<std::string>& required) {
    const std::string config = CommandLineProbe({"--print-config"}).output;
    std::istringstream help(printHelp());
    std::size_t flags = 0;
    for (std::string flag; help >> flag;) {
      const bool is_flag = flag.starts_with("--") && flag.size() > 2;
      if (!is_flag || config.find("\n#" + flag.substr(2) + " =") == std::string::npos) continue;
      ++flags;
    }
    std::vector<std::pair<std::string, std::string>> keys;
    std::istringstream lines(config);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.size() < 2 || line[0] != '#' || line[1] == ' ') continue;
      ++count;
      const std::size_t equals = line.find(" =");
      const std::string key = line.substr(1, equals - 1);
      EXPECT_EQ(config.find("\n#" + key + " ="), config.rfind("\n#" + key + " =")) << key;
      if (equals + 2 < line.size()) keys.emplace_back(key, line.substr(equals + 3));
    }
    EXPECT_GT(keys.size(), 5U) << config;
    EXPECT_GE(flags, count - 1) << "one key may be an argument without a flag";
    CommandLineProbe run = withConfig(keys, required);
    EXPECT_EQ(run.exit_code, std::nullopt) << run.error;
    EXPECT_EQ(writeConfig(*kCommandLine(run.settings)) + "\n", config);
  }

  /// One line on stderr that holds all of `parts`.
  void expectErrorWith(const std::vector<std::string>& parts) const {
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
    for (const std::string& part : parts) {
      EXPECT_NE(error.find(part), std::string::npos) << part << " in: " << error;
    }
  }
};

}  // namespace hapticast::testing_support
