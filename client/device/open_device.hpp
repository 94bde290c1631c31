// SPDX-License-Identifier: MIT
// List of the device kinds (--device), and the functions that open a device.
// client/device/drivers.md describes how to add a kind.
// Thread: main, before the loop.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/device/device_profile.hpp"
#include "client/device/falcon/falcon_settings.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

/// Arguments for opening a device. All references must outlive the device.
struct DeviceRequest {
  std::string kind = {};  ///< name of the kind; openDevice() and its like set it
  /// --profile: a built-in name or a file; empty: the default of the kind.
  std::string profile = {};
  std::string hand = "press";  ///< --hand: name of a script, or a CSV file
  const Clock& clock;
  /// Target of the window's pointer, or null if there is no window. Only the device may read it.
  LatestValue<PointerTarget>* pointer = nullptr;
  FalconSettings falcon = {};
  std::map<std::string, std::string> options = {};  ///< --device-option: settings of the driver
  std::string helper_program = {};  ///< path of hapticast-device; empty: findHelperProgram()
  /// Receives lines about the progress while the device opens.
  std::function<void(const std::string& line)> log = [](const std::string& /*line*/) {};
};

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

/// A kind of device.
struct DeviceKind {
  const char* name;         ///< name for --device
  const char* description;  ///< one line for --help
  OpenDevice* open;
  /// Returns one line for each detected device; may throw. Null means that a device of this kind is
  /// always available.
  std::vector<std::string> (*list)(const DeviceRequest& request) = nullptr;
  bool by_itself = true;  ///< true: --device auto may select this kind
};

/// Returns all kinds of this build. For --device auto the client uses the device that findDevice()
/// returns. If that is null, it opens the mouse if there is a window, else the first kind.
std::span<const DeviceKind> deviceKinds() noexcept;

/// Returns the names for --device, without `auto`: those of deviceKinds(), and those of drivers in
/// files of their own.
std::vector<std::string> deviceNames();

/// Returns the profile `name_or_file` (loadDeviceProfile()). For an empty name it returns the
/// profile `own`. Throws like OpenDevice.
PlantProfile loadProfile(const std::string& name_or_file, const std::string& own = "omni");

/// Opens a device of the kind `name` and returns it. If `name` is "auto", it opens the mouse if
/// request.pointer is not null, else the first kind. It then detects no devices. Throws like
/// OpenDevice, and also for an unknown name.
std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request);

/// Returns true if `device` follows DeviceRequest::pointer: it is a mouse.
[[nodiscard]] bool followsPointer(const HapticDevice& device);

/// Opens the first detected device that answers, and returns it. Returns null if no detected device
/// answers. Logs detected devices that do not answer.
std::unique_ptr<HapticDevice> findDevice(const DeviceRequest& request);

/// Returns the text of --list-devices. It has one line for each kind and for each driver in a file,
/// with the detected devices of the kind.
std::string listDevices(const DeviceRequest& request);

}  // namespace hapticast::client
