// SPDX-License-Identifier: MIT
// --config FILE: `key = value` lines (readKeyValues()), every flag a key of the same name, a list a
// key repeated. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace hapticast {

/// What is wrong inside a config file, in words that need only the file's name in front.
class ConfigFileError : public CLI::ParseError {
 public:
  explicit ConfigFileError(const std::string& what)
      : CLI::ParseError("ConfigFileError", what, CLI::ExitCodes::ConfigError) {}
};

/// Lets `--config FILE` hold every flag of `app`; unknown keys are refused by ConfigFileError.
void addConfigFile(CLI::App& app);

}  // namespace hapticast
