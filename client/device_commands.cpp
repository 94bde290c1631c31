// SPDX-License-Identifier: MIT
#include "client/device_commands.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <csignal>
#include <cstdio>

#include "client/device/calibrate.hpp"
#include "client/device/check_device.hpp"
#include "client/device/falcon/falcon_settings.hpp"
#include "client/device/open_device.hpp"
#include "client/report/fault_log.hpp"
#include "common/cli/run_program.hpp"
#include "common/private_file.hpp"

namespace hapticast::client {

namespace {

std::atomic<bool> stop_command{false};

void stopAtSignals() {
  const auto stop = [](int /*signal*/) { stop_command = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, stop);
}

void logInfo(const std::string& line) { spdlog::info("{}", line); }

DeviceRequest toRequest(const Settings& settings, const Clock& clock) {
  return {.profile = settings.profile,
          .clock = clock,
          .options = settings.device_options,
          .log = logInfo};
}

std::string checkFile() { return (stateFolder() / "checked-devices").string(); }

}  // namespace

void printDevices(const Settings& settings) {
  const SteadyClock clock;
  std::fputs(listDevices(toRequest(settings, clock)).c_str(), stdout);
}

int runDeviceCheck(const Settings& settings) {
  const SteadyClock clock;
  const auto device = openDevice(settings.check_device, toRequest(settings, clock));
  stopAtSignals();
  const auto check = checkDevice(*device, clock, stop_command, logInfo);
  if (!check) return kDone;
  if (!device->id().empty()) storeCheck(checkFile(), device->id(), device->profile(), *check);
  if (check->fault.empty()) {
    spdlog::info(
        "check: {} follows in sign and axis; it moves like {:.0f} g, {} ms pass from a "
        "position to its force, and its position moves in steps of {:.3f} mm",
        settings.check_device, 1e3 * check->mass_kg, check->delay_ticks, check->count_mm);
    if (!check->note.empty()) spdlog::warn("check: {}", check->note);
    return kDone;
  }
  spdlog::error("--check-device {}: refused: {}. The client will not use the device",
                settings.check_device, check->fault);
  return kFailed;
}

int runFalconCalibration(const Settings& settings) {
  const SteadyClock clock;
  const auto device = openDevice("falcon", toRequest(settings, clock));
  stopAtSignals();
  const auto options = selectDriverOptions(settings.device_options, "falcon");
  const auto set = options.find("gain");
  // The driver has checked it.
  const double used = set == options.end() ? kFalconGain : parseFalconGain(set->second).value();
  const auto gain = calibrate(*device, clock, used, settings.calibration_g, stop_command, logInfo);
  if (!gain) return kDone;
  if (settings.config_file.empty()) {
    spdlog::info("put this line into a file for --config: falcon-gain = {:.0f}", *gain);
  } else {
    storeGain(settings.config_file, *gain);
    spdlog::info("falcon-gain = {:.0f} is stored in {}", *gain, settings.config_file);
  }
  return kDone;
}

void applyStoredCheck(const HapticDevice& device, DeviceProfile& profile) {
  if (device.id().empty()) return;
  const auto check = readCheck(checkFile(), device.id(), profile);
  if (!check) return;
  if (!check->fault.empty())
    throw DeviceAbsent(
        fmt::format("the device {} failed its last check: {}; run --check-device "
                    "again",
                    device.id(), check->fault));
  applyCheck(*check, profile);
}

}  // namespace hapticast::client
