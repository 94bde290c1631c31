// SPDX-License-Identifier: MIT
#include "client/commands/run_command.hpp"
#include "client/settings/command_line.hpp"
#include "common/cli/run_program.hpp"

int main(int argc, char** argv) {
  hapticast::client::Settings settings;
  if (const auto exit_code = hapticast::client::readCommandLine(settings, argc, argv))
    return *exit_code;
  if (settings.command == hapticast::client::Command::kList)
    return hapticast::client::runList(settings);
  return hapticast::runProgram(settings.quiet,
                               [&] { return hapticast::client::runCommand(settings); });
}
