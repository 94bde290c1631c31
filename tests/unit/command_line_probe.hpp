// SPDX-License-Identifier: MIT
// A program's command line, parsed as main() does it, with all it says.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::testing_support {

template <class Settings, auto kCommandLine>
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
    exit_code = parseCommandLine(*app, static_cast<int>(argv.size()), argv.data());
    output = ::testing::internal::GetCapturedStdout();
    error = ::testing::internal::GetCapturedStderr();
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

  /// One line on stderr that holds all of `parts`.
  void expectErrorWith(const std::vector<std::string>& parts) const {
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
    for (const std::string& part : parts) {
      EXPECT_NE(error.find(part), std::string::npos) << part << " in: " << error;
    }
  }
};

}  // namespace hapticast::testing_support
