// SPDX-License-Identifier: MIT
// Config file (--config FILE): lines `key = value` (readKeyValues()). Every flag is a key of the
// same name; a list repeats its key. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace hapticast {

/// An error inside a config file. The message needs only the file's name in front.
class ConfigFileError : public CLI::ParseError {
 public:
  explicit ConfigFileError(const std::string& what)
      : CLI::ParseError("ConfigFileError", what, CLI::ExitCodes::ConfigError) {}
};

/// Adds `--config FILE`, which accepts every flag of `app`. Unknown keys cause a ConfigFileError.
void addConfigFile(CLI::App& app);

}  // namespace hapticast
