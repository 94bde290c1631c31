// SPDX-License-Identifier: MIT
// The kinds of haptic devices (--device), and the one place that opens one. README.md says how a
// further kind is added.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/device/device_profile.hpp"
#include "client/device/falcon_settings.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/pointer.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

/// What a kind is opened with. What it refers to outlives the device.
struct DeviceRequest {
  std::string profile = {};    ///< --profile: a built-in name or a file; empty: the kind's own
  std::string hand = "press";  ///< --hand: a script's name or a CSV file
  const Clock& clock;
  /// Where a window's pointer is; null: there is no window. The device is its one reader.
  LatestValue<PointerTarget>* pointer = nullptr;
  FalconSettings falcon = {};
  /// Called while it is opened, with what takes a while.
  std::function<void(const std::string& line)> log = [](const std::string& /*line*/) {};
};

/// A device that is asked for is not there, or cannot be had; the input may be right.
class DeviceAbsent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens a device of one kind. Throws std::runtime_error with one line that names the flag, the
/// value and what is allowed, DeviceAbsent where there is none. Before the loop.
using OpenDevice = std::unique_ptr<HapticDevice>(const DeviceRequest& request);

struct DeviceKind {
  const char* name;         ///< as --device has it
  const char* description;  ///< one line for --help
  OpenDevice* open;
  /// What is plugged in, a line each; may throw. Null: the kind is always there.
  std::vector<std::string> (*list)() = nullptr;
  bool by_itself = true;  ///< `auto` takes what is plugged in
};

/// All kinds of this build: `auto` opens what findDevice() finds, else where there is a window the
/// mouse, else the first one.
std::span<const DeviceKind> deviceKinds() noexcept;

/// The profile of --profile; of an empty one the kind's own. Throws as OpenDevice does.
PlantProfile loadProfile(const std::string& name_or_file, const std::string& own = "omni");

/// Opens a device of the kind `name`, or `auto`. Throws as OpenDevice does, and for an unknown
/// name.
std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request);

/// The first real device that is plugged in and answers; null: there is none. What is plugged in
/// and does not is told.
std::unique_ptr<HapticDevice> findDevice(const DeviceRequest& request);

/// --list-devices: every kind with what was found of it, a line each.
std::string listDevices();

}  // namespace hapticast::client
