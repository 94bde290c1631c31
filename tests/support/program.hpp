// SPDX-License-Identifier: MIT
// The main() of a program that comes with the tests.
#pragma once

#include <exception>
#include <iostream>
#include <memory>

#include "common/cli/parse.hpp"
#include "common/text.hpp"

namespace hapticast::testing {

/// Parses the command line into Settings and runs: 0, what parsing ends with, or 1 with one line
/// that begins with `name`.
template <class Settings>
int program(const char* name, std::unique_ptr<CLI::App> (*command_line)(Settings&),
            void (*run)(const Settings&), int argc, char** argv) {
  constexpr int kDone = 0, kFailed = 1;
  try {
    Settings settings;
    const auto app = command_line(settings);
    if (const auto exit_code = parseCommandLine(*app, argc, argv)) return *exit_code;
    run(settings);
    return kDone;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << sanitizeUtf8(error.what()) << "\n";
    return kFailed;
  }
}

}  // namespace hapticast::testing
