// SPDX-License-Identifier: MIT
#include "client/device/open_device.hpp"

#include <array>
#include <stdexcept>
#include <string_view>

namespace hapticast::client {

// Each is defined in a file of its own.
OpenDevice openVirtual;
OpenDevice openMouse;

std::span<const DeviceKind> deviceKinds() noexcept {
  static constexpr std::array kKinds = {
      DeviceKind{"virtual", "a simulated one in a simulated hand", openVirtual},
      DeviceKind{"mouse", "the pointer in the window, on a spring that shows the force", openMouse},
  };
  return kKinds;
}

PlantProfile loadProfile(const std::string& name_or_file) {
  try {
    return loadDeviceProfile(name_or_file);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("--profile ") + error.what());
  }
}

std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request) {
  std::string names = "auto";
  for (const DeviceKind& kind : deviceKinds()) {
    const bool best = request.pointer == nullptr ? &kind == &deviceKinds().front()
                                                 : std::string_view(kind.name) == "mouse";
    if (name == kind.name || (name == "auto" && best)) return kind.open(request);
    names += "|" + std::string(kind.name);
  }
  throw std::runtime_error("--device " + name + ": is not one of " + names);
}

}  // namespace hapticast::client
