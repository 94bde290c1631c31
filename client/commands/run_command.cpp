// SPDX-License-Identifier: MIT
#include "client/commands/run_command.hpp"

#include <spdlog/spdlog.h>

#include <exception>
#include <functional>

#include "client/commands/control_command.hpp"
#include "client/commands/device_commands.hpp"
#include "client/commands/replay_command.hpp"
#include "client/commands/touch_command.hpp"
#include "client/desk/user_interface.hpp"
#include "client/device/open_device.hpp"
#include "client/servers/find_server.hpp"
#include "client/settings/command_line.hpp"
#include "client/study_run/study_command.hpp"
#include "common/cli/run_program.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

/// Returns the exit code of `command`. Logs its exception, except for a device that is absent.
int runOrRefuse(const std::function<int()>& command) {
  try {
    return command();
  } catch (const DeviceAbsent&) {
    throw;  // a failure, no wrong input
  } catch (const std::exception& error) {
    spdlog::error("{}", sanitizeUtf8(error.what()));
    return kWrongInput;
  }
}

/// Runs a subcommand with a person at the device. Returns its exit code.
int runAtDesk(const Settings& settings) {
  requireVirtualHand(settings);
  requireDistinctOutputs(settings);
  const SteadyClock clock;
  return settings.command == Command::kStudy ? runStudy(settings, clock)
                                             : runTouch(settings, clock, openViews(settings));
}

}  // namespace

int runCommand(const Settings& settings) {
  switch (settings.command) {
    case Command::kReplay:
      return runOrRefuse([&] { return runReplay(settings); });
    case Command::kCheck:
      return settings.calibration_g > 0.0 ? runFalconCalibration(settings)
                                          : runDeviceCheck(settings);
    case Command::kControl:
      return runOrRefuse([&] { return controlServer(settings) ? kDone : kFailed; });
    case Command::kList:
    case Command::kStudy:
    case Command::kTouch:
      break;
  }
  return runOrRefuse([&] { return runAtDesk(settings); });
}

int runList(const Settings& settings) {
  if (!settings.list_devices) return listServers() ? kDone : kFailed;
  printDevices(settings);
  return kDone;
}

}  // namespace hapticast::client
