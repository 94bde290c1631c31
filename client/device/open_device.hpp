// SPDX-License-Identifier: MIT
// The kinds of haptic devices (--device), and the one place that opens one. README.md says how a
// further kind is added.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "client/device/device_profile.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/pointer.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/latest_value.hpp"

namespace hapticast::client {

/// What a kind is opened with. What it refers to outlives the device.
struct DeviceRequest {
  std::string profile = "omni";  ///< --profile: a built-in name or a file
  std::string hand = "press";    ///< --hand: a script's name or a CSV file
  const Clock& clock;
  LatestValue<TickReport>& seen;  ///< what the room publishes; the device is its one reader
  /// Where a window's pointer is; null: there is no window. The device is its one reader.
  LatestValue<PointerTarget>* pointer = nullptr;
};

/// Opens a device of one kind. Throws std::runtime_error with one line that names the flag, the
/// value and what is allowed. Before the loop.
using OpenDevice = std::unique_ptr<HapticDevice>(const DeviceRequest& request);

struct DeviceKind {
  const char* name;         ///< as --device has it
  const char* description;  ///< one line for --help
  OpenDevice* open;
};

/// All kinds of this build: `auto` opens the first one, where there is a window the mouse.
std::span<const DeviceKind> deviceKinds() noexcept;

/// The profile of --profile. Throws as OpenDevice does.
PlantProfile loadProfile(const std::string& name_or_file);

/// Opens a device of the kind `name`, or `auto`. Throws as OpenDevice does, and for an unknown
/// name.
std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request);

}  // namespace hapticast::client
