// SPDX-License-Identifier: MIT
#include "client/commands/device_commands.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdio>

#include "client/desk/first_check.hpp"
#include "client/device/calibrate.hpp"
#include "client/device/falcon/falcon_settings.hpp"
#include "client/device/loop/realtime_thread.hpp"
#include "client/device/open_device.hpp"
#include "common/cli/run_program.hpp"

namespace hapticast::client {

namespace {

void logInfo(const std::string& line) { spdlog::info("{}", line); }

DeviceRequest toRequest(const Settings& settings, const Clock& clock) {
  return {.profile = settings.profile,
          .clock = clock,
          .options = settings.device_options,
          .log = logInfo};
}

}  // namespace

void printDevices(const Settings& settings) {
  const SteadyClock clock;
  std::fputs(listDevices(toRequest(settings, clock)).c_str(), stdout);
}

int runDeviceCheck(const Settings& settings) {
  const SteadyClock clock;
  DeviceRequest request = toRequest(settings, clock);
  request.hand = kFreeGrip;
  const bool searches = settings.check_device == "auto";
  const auto device = searches ? findDevice(request) : openDevice(settings.check_device, request);
  if (device == nullptr) {
    spdlog::error(
        "no device was found: is it plugged in? hapticast-client list --devices says why");
    return kFailed;
  }
  const std::atomic<bool>& stop = stopAtSignals();
  spdlog::info("check: let go of the grip; the client pushes it six times, with 0.3 N for 0.12 s");
  (void)requestRealtime();  // as the loop that touches
  const auto check = checkDevice(*device, clock, stop, logInfo);
  if (!check) return kDone;
  storeResult(*device, *check);
  if (check->fault.empty()) return kDone;
  spdlog::error("check {}: refused: {}", settings.check_device, check->fault);
  return kFailed;
}

int runFalconCalibration(const Settings& settings) {
  const SteadyClock clock;
  const auto device = openDevice("falcon", toRequest(settings, clock));
  const std::atomic<bool>& stop = stopAtSignals();
  const auto options = selectDriverOptions(settings.device_options, "falcon");
  const auto set = options.find("gain");
  (void)requestRealtime();
  // The driver has checked it.
  const double used = set == options.end() ? kFalconGain : parseFalconGain(set->second).value();
  const auto gain = calibrate(*device, clock, used, settings.calibration_g, stop, logInfo);
  if (!gain) return kDone;
  if (settings.config_file.empty()) {
    spdlog::info("put this line into a file for --config: falcon-gain = {:.0f}", *gain);
  } else {
    storeGain(settings.config_file, *gain);
    spdlog::info("falcon-gain = {:.0f} is stored in {}", *gain, settings.config_file);
  }
  return kDone;
}

}  // namespace hapticast::client
