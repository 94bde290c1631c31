// SPDX-License-Identifier: MIT
// Arguments for opening a device, and the type of the functions that open one.
// Thread: main, before the loop.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "client/device/profile/device_profile.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

/// Value of DeviceRequest::hand: the hand releases the grip.
inline constexpr const char* kFreeGrip = "free";

/// Arguments for opening a device. All references must outlive the device.
struct DeviceRequest {
  std::string kind = {};  ///< name of the kind; the functions of open_device.hpp set it
  /// --profile: a built-in name or a file; empty: the default of the kind.
  std::string profile = {};
  std::string hand = "press";  ///< --hand: name of a script, a CSV file, or kFreeGrip
  const Clock& clock;
  /// Target of the window's pointer, or null if there is no window. Only the device may read it.
  LatestValue<PointerTarget>* pointer = nullptr;
  /// --device-option: settings of drivers. A key without a dot is for every driver. A key
  /// DRIVER.KEY is only for the driver named DRIVER.
  std::map<std::string, std::string> options = {};
  std::string helper_program = {};  ///< path of hapticast-device; empty: findHelperProgram()
  /// Receives lines about the progress while the device opens.
  std::function<void(const std::string& line)> log = [](const std::string& /*line*/) {};
};

/// Returns the entries of `options` (DeviceRequest::options) for the driver `driver`, with keys
/// without the prefix DRIVER. An entry with that prefix replaces the entry without it.
std::map<std::string, std::string> selectDriverOptions(
    const std::map<std::string, std::string>& options, const std::string& driver);

/// Returns the profile `name_or_file` (loadDeviceProfile()). For an empty name it returns the
/// profile `own`. Throws like OpenDevice.
PlantProfile loadProfile(const std::string& name_or_file, const std::string& own = "omni");

/// The requested device is missing or cannot be opened. The user's input is not the cause.
class DeviceAbsent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Type of the functions that open a device of one kind. Such a function opens the device and
/// returns it. If the device is missing, it throws DeviceAbsent. If a setting in `request` is
/// invalid, it throws std::runtime_error with one line: the flag, its value and the allowed values.
/// Call it before the loop.
using OpenDevice = std::unique_ptr<HapticDevice>(const DeviceRequest& request);

}  // namespace hapticast::client
