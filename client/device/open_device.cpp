// SPDX-License-Identifier: MIT
#include "client/device/open_device.hpp"

#include <array>
#include <stdexcept>
#include <string_view>

namespace hapticast::client {

// Each one is defined in a file of its own.
OpenDevice openVirtual;
OpenDevice openMouse;
OpenDevice openFalcon;
std::vector<std::string> listFalcons();
OpenDevice openGamepad;
std::vector<std::string> listGamepads();

std::span<const DeviceKind> deviceKinds() noexcept {
  static constexpr std::array kKinds = {
    DeviceKind{"virtual", "a simulated device in a simulated hand", openVirtual},
    DeviceKind{"mouse", "the pointer in the window, on a spring that shows the force", openMouse},
#if HAPTICAST_LIBUSB
    DeviceKind{"falcon", "a Novint Falcon on USB", openFalcon, listFalcons},
#endif
#if HAPTICAST_SDL2
    // Gamepads are often plugged in without a purpose, and a mouse points better: explicit choice
    // only.
    DeviceKind{"gamepad", "its sticks lead the tip, its motors rumble with the force", openGamepad,
               listGamepads, /*by_itself=*/false},
#endif
  };
  return kKinds;
}

PlantProfile loadProfile(const std::string& name_or_file, const std::string& own) {
  try {
    return loadDeviceProfile(name_or_file.empty() ? own : name_or_file);
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

std::unique_ptr<HapticDevice> findDevice(const DeviceRequest& request) {
  for (const DeviceKind& kind : deviceKinds()) {
    if (kind.list == nullptr || !kind.by_itself) continue;
    try {
      if (!kind.list().empty()) return kind.open(request);
    } catch (const DeviceAbsent& error) {
      request.log(std::string("the client continues without this device: ") + error.what());
    } catch (const std::runtime_error&) {
      // Without access nothing counts as plugged in; --list-devices shows the reason.
    }
  }
  return nullptr;
}

std::string listDevices() {
  std::string text;
  for (const DeviceKind& kind : deviceKinds()) {
    text.append(kind.name).append(": ").append(kind.description);
    if (kind.list != nullptr) {
      try {
        const auto lines = kind.list();
        if (lines.empty()) text.append("; none was found: is it plugged in?");
        for (const std::string& line : lines) text.append("; ").append(line);
      } catch (const std::runtime_error& error) {
        text.append("; ").append(error.what());
      }
    }
    text.append("\n");
  }
  return text;
}

}  // namespace hapticast::client
