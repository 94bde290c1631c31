// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <exception>
#include <functional>
#include <utility>

#include "client/commands/control_command.hpp"
#include "client/commands/device_commands.hpp"
#include "client/commands/replay_command.hpp"
#include "client/commands/touch_command.hpp"
#include "client/desk/user_interface.hpp"
#include "client/device/open_device.hpp"
#include "client/discovery/find_server.hpp"
#include "client/settings/command_line.hpp"
#include "client/study_run/study_command.hpp"
#include "common/cli/run_program.hpp"
#include "common/text.hpp"

namespace {

using hapticast::kDone;
using hapticast::kFailed;
using hapticast::kWrongInput;
using hapticast::client::Command;
using hapticast::client::Settings;

/// Returns the exit code of `command`. Logs its exception, except for a device that is absent.
int runOrRefuse(const std::function<int()>& command) {
  try {
    return command();
  } catch (const hapticast::client::DeviceAbsent&) {
    throw;  // a failure, no wrong input
  } catch (const std::exception& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kWrongInput;
  }
}

/// Runs a subcommand with a person at the device. Returns its exit code.
int runAtDesk(const Settings& settings) {
  hapticast::client::requireVirtualHand(settings);
  hapticast::client::requireDistinctOutputs(settings);
  const hapticast::SteadyClock clock;
  auto views = hapticast::client::openViews(settings);
  return settings.command == Command::kStudy
             ? hapticast::client::runStudy(settings, clock, std::move(views))
             : hapticast::client::runTouch(settings, clock, std::move(views));
}

int runList(const Settings& settings) {
  if (!settings.list_devices) return hapticast::client::listServers() ? kDone : kFailed;
  hapticast::client::printDevices(settings);
  return kDone;
}

int runCommand(const Settings& settings) {
  switch (settings.command) {
    case Command::kReplay:
      return runOrRefuse([&] { return hapticast::client::runReplay(settings); });
    case Command::kCheck:
      return settings.calibration_g > 0.0 ? hapticast::client::runFalconCalibration(settings)
                                          : hapticast::client::runDeviceCheck(settings);
    case Command::kControl:
      return runOrRefuse(
          [&] { return hapticast::client::controlServer(settings) ? kDone : kFailed; });
    case Command::kList:
    case Command::kStudy:
    case Command::kTouch:
      break;
  }
  return runOrRefuse([&] { return runAtDesk(settings); });
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  if (const auto exit_code = hapticast::client::readCommandLine(settings, argc, argv))
    return *exit_code;
  if (settings.command == Command::kList) return runList(settings);
  return hapticast::runProgram(settings.quiet, [&settings] { return runCommand(settings); });
}
