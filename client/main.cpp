// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "client/app.hpp"
#include "client/command_line.hpp"
#include "client/device/calibrate.hpp"
#include "client/device/open_device.hpp"
#include "client/discovery/find_server.hpp"
#include "client/user_interface.hpp"
#include "common/cli/run_program.hpp"
#include "common/text.hpp"

namespace {

using hapticast::kDone;
using hapticast::kFailed;
using hapticast::kWrongInput;

std::atomic<bool> stop_calibration{false};

/// --falcon-calibrate.
int calibrateFalcon(const hapticast::client::Settings& settings) {
  using namespace hapticast::client;
  const auto log_line = [](const std::string& line) { spdlog::info("{}", line); };
  const hapticast::SteadyClock clock;
  const auto device = openDevice(
      "falcon",
      {.profile = settings.profile, .clock = clock, .falcon = settings.falcon, .log = log_line});
  const auto stop = [](int /*signal*/) { stop_calibration = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, stop);
  const auto gain = calibrate(*device, clock, settings.falcon.gain, settings.calibration_g,
                              stop_calibration, log_line);
  if (!gain) return kDone;
  if (settings.config_file.empty()) {
    spdlog::info("put this line into a file for --config: falcon-gain = {:.0f}", *gain);
  } else {
    storeGain(settings.config_file, *gain);
    spdlog::info("falcon-gain = {:.0f} is stored in {}", *gain, settings.config_file);
  }
  return kDone;
}

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

}  // namespace

int main(int argc, char** argv) {
  hapticast::client::Settings settings;
  if (const auto exit_code = hapticast::client::readCommandLine(settings, argc, argv))
    return *exit_code;
  if (settings.list_devices) {
    const hapticast::SteadyClock clock;
    std::fputs(hapticast::client::listDevices(
                   {.clock = clock, .falcon = settings.falcon, .options = settings.device_options})
                   .c_str(),
               stdout);
    return kDone;
  }
  if (settings.list_servers) return hapticast::client::listServers() ? kDone : kFailed;
  return hapticast::runProgram(settings.quiet, [&settings] {
    return settings.calibration_g > 0.0 ? calibrateFalcon(settings) : runClient(settings);
  });
}
