// SPDX-License-Identifier: MIT
#include "common/cli/version.hpp"

#include <CLI/CLI.hpp>

namespace hapticast {

void addVersion(CLI::App& app, const std::string& built_in) {
  const std::string text = app.get_name() + " " HAPTICAST_VERSION " (" + built_in +
                           ")\noptional packages: " HAPTICAST_OPTIONAL;
  app.set_version_flag("--version", text);
  app.footer(text);
}

}  // namespace hapticast
