// SPDX-License-Identifier: MIT
#include "client/device/open_device.hpp"

#include <array>
#include <stdexcept>

namespace hapticast::client {

// Each is defined in a file of its own.
OpenDevice openVirtual;

std::span<const DeviceKind> deviceKinds() noexcept {
  static constexpr std::array kKinds = {
      DeviceKind{"virtual", "a simulated one in a simulated hand", openVirtual},
  };
  return kKinds;
}

std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request) {
  if (name == "auto") return deviceKinds().front().open(request);
  std::string names = "auto";
  for (const DeviceKind& kind : deviceKinds()) {
    if (name == kind.name) return kind.open(request);
    names += "|" + std::string(kind.name);
  }
  throw std::runtime_error("--device " + name + ": is not one of " + names);
}

}  // namespace hapticast::client
