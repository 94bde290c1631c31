// SPDX-License-Identifier: MIT
// Registry and factory of the device kinds (--device). client/device/README.md describes how to add
// a kind.
// Thread: main, before the loop.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/device/device_profile.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

// Settings of a Falcon (--falcon-...).
// Thread: any.

/// Default gain in counts/(N m) at the arm. Measured: the frames of a stock driver correspond to
/// 3500. Other drivers send three times as much, and devices differ slightly.
inline constexpr double kFalconGain = 3500.0;

struct FalconSettings {
  std::string firmware_file = {};  ///< empty: the default file, or firmware that already runs
  std::string serial = {};         ///< empty: the first device
  double gain = kFalconGain;       ///< counts/(N m) at the arm
  bool event_character = true;     ///< off: only to measure its effect
};

/// Arguments of a device. All references must outlive the device.
struct DeviceRequest {
  std::string profile = {};    ///< --profile: a built-in name or a file; empty: default of the kind
  std::string hand = "press";  ///< --hand: name of a script, or a CSV file
  const Clock& clock;
  /// Target of the window's pointer; null without a window. The device must be its only reader.
  LatestValue<PointerTarget>* pointer = nullptr;
  FalconSettings falcon = {};
  /// Receives progress lines while the device opens.
  std::function<void(const std::string& line)> log = [](const std::string& /*line*/) {};
};

/// The requested device is missing or cannot be opened. The input may still be correct.
class DeviceAbsent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens a device of one kind. Throws std::runtime_error with one line: flag, value and the allowed
/// values. Throws DeviceAbsent if there is no device. Call before the loop.
using OpenDevice = std::unique_ptr<HapticDevice>(const DeviceRequest& request);

/// A kind of device.
struct DeviceKind {
  const char* name;         ///< name for --device
  const char* description;  ///< one line for --help
  OpenDevice* open;
  /// Lists the detected devices, one line each; may throw. Null: the kind is always available.
  std::vector<std::string> (*list)() = nullptr;
  bool by_itself = true;  ///< `auto` may select it
};

/// All kinds of this build. `auto` opens the result of findDevice(), else the mouse if there is a
/// window, else the first kind.
std::span<const DeviceKind> deviceKinds() noexcept;

/// Returns the profile `name_or_file`; for an empty name the profile `own`. Throws like OpenDevice.
PlantProfile loadProfile(const std::string& name_or_file, const std::string& own = "omni");

/// Opens a device of the kind `name`, or the fallback of `auto` without a detection. Throws like
/// OpenDevice, and for an unknown name.
std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request);

/// Opens the first detected device that answers; null if there is none. Logs detected devices that
/// do not answer.
std::unique_ptr<HapticDevice> findDevice(const DeviceRequest& request);

/// Returns the text of --list-devices: one line for each kind, with its detected devices.
std::string listDevices();

}  // namespace hapticast::client
