// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "client/commands/app.hpp"
#include "client/commands/control_command.hpp"
#include "client/commands/device_commands.hpp"
#include "client/commands/replay_command.hpp"
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

int runClient(const hapticast::client::Settings& settings) {
  const hapticast::SteadyClock clock;
  std::unique_ptr<hapticast::client::App> app;
  try {
    hapticast::client::requireVirtualHand(settings);
    hapticast::client::requireDistinctOutputs(settings);
    app = std::make_unique<hapticast::client::App>(settings, clock,
                                                   hapticast::client::openViews(settings));
  } catch (const hapticast::client::DeviceAbsent& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kFailed;
  } catch (const std::exception& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kWrongInput;
  }
  return app->run() ? kDone : kFailed;
}

/// Returns the exit code of `command`. Logs its exception.
int runOrRefuse(const std::function<int()>& command) {
  try {
    return command();
  } catch (const std::exception& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kWrongInput;
  }
}

int runCommand(const hapticast::client::Settings& settings) {
  if (settings.control) {
    return runOrRefuse(
        [&] { return hapticast::client::controlServer(settings) ? kDone : kFailed; });
  }
  if (!settings.study.file.empty()) {
    return runOrRefuse([&] {
      hapticast::client::requireVirtualHand(settings);
      hapticast::client::requireDistinctOutputs(settings);
      return hapticast::client::runStudy(settings, hapticast::SteadyClock(),
                                         hapticast::client::openViews(settings));
    });
  }
  if (!settings.replay_file.empty())
    return runOrRefuse([&] { return hapticast::client::runReplay(settings); });
  if (settings.calibration_g > 0.0) return hapticast::client::runFalconCalibration(settings);
  if (!settings.check_device.empty()) return hapticast::client::runDeviceCheck(settings);
  return runClient(settings);
}

}  // namespace

int main(int argc, char** argv) {
  hapticast::client::Settings settings;
  if (const auto exit_code = hapticast::client::readCommandLine(settings, argc, argv))
    return *exit_code;
  if (settings.list_devices) {
    hapticast::client::printDevices(settings);
    return kDone;
  }
  if (settings.list_servers) return hapticast::client::listServers() ? kDone : kFailed;
  return hapticast::runProgram(settings.quiet, [&settings] { return runCommand(settings); });
}
