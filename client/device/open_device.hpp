// SPDX-License-Identifier: MIT
// List of the device kinds (--device), and the functions that open a device.
// client/device/drivers.md describes how to add a kind.
// Thread: main, before the loop.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/device/device_request.hpp"

namespace hapticast::client {

/// A kind of device.
struct DeviceKind {
  const char* name;         ///< name for --device
  const char* description;  ///< one line for --help
  OpenDevice* open;
  /// Returns one line for each detected device; may throw. Null means that a device of this kind is
  /// always available.
  std::vector<std::string> (*list)(const DeviceRequest& request) = nullptr;
  bool by_itself = true;  ///< true: --device auto may select this kind
  /// Names of products, lower case, each followed by a space. For such a name after --device the
  /// client suggests this kind.
  const char* products = "";
};

/// Returns all kinds of this build. For --device auto the client uses the device that findDevice()
/// returns. If that is null, the client opens the mouse if there is a window, else the first kind.
std::span<const DeviceKind> deviceKinds() noexcept;

/// Returns the names for --device, without `auto`: the kinds of deviceKinds(), and the drivers that
/// are installed as files (helper/driver_files.hpp).
std::vector<std::string> deviceNames();

/// Opens a device of the kind `name` and returns it. If `name` is "auto", it opens the mouse if
/// request.pointer is not null, else the first kind; it does not search for connected devices.
/// Throws like OpenDevice, and also for an unknown name.
std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request);

/// Returns true if `device` is the mouse, whose HIP follows DeviceRequest::pointer.
[[nodiscard]] bool followsPointer(const HapticDevice& device);

/// Searches for connected devices, opens the first one that answers, and returns it. Returns null
/// if there is none. Logs each connected device that cannot be opened.
std::unique_ptr<HapticDevice> findDevice(const DeviceRequest& request);

/// Returns the text of `list --devices`. It has one line for each kind and for each driver in a
/// file, with the detected devices of the kind.
std::string listDevices(const DeviceRequest& request);

}  // namespace hapticast::client
