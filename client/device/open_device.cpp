// SPDX-License-Identifier: MIT
#include "client/device/open_device.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "client/device/helper/driver_files.hpp"
#include "client/device/helper/helper_device.hpp"
#include "common/text.hpp"

namespace hapticast::client {

// Each one is defined in a file of its own.
OpenDevice openVirtual;
OpenDevice openMouse;
OpenDevice openGamepad;
std::vector<std::string> listGamepads(const DeviceRequest& request);

std::span<const DeviceKind> deviceKinds() noexcept {
  static constexpr std::array kKinds = {
    DeviceKind{"virtual", "a simulated device in a simulated hand", openVirtual},
    DeviceKind{"mouse", "the pointer in the window, on a spring that shows the force", openMouse},
#if HAPTICAST_LIBUSB
    DeviceKind{"falcon", "a Novint Falcon on USB", openHelperDevice, listHelperDevices, true,
               "novint "},
#endif
    DeviceKind{"inverse3", "a Haply Inverse3 or Minverse, through its service", openHelperDevice,
               listHelperDevices, true, "haply minverse "},
    DeviceKind{"dhd", "Force Dimension omega, delta, sigma, by the maker's library",
               openHelperDevice, listHelperDevices, true,
               "omega delta sigma lambda forcedimension "},
    DeviceKind{"touch", "a Touch (Phantom Omni), by the maker's library", openHelperDevice,
               listHelperDevices, true, "omni phantom geomagic sensable 3dsystems "},
#if HAPTICAST_SDL2
    // Gamepads are often plugged in without a purpose, and a mouse points better: explicit choice
    // only.
    DeviceKind{"gamepad", "its sticks lead the tip, its motors rumble with the force", openGamepad,
               listGamepads, /*by_itself=*/false},
#endif
  };
  return kKinds;
}

namespace {

/// Returns `request` for the kind `name`.
DeviceRequest setKind(DeviceRequest request, const std::string& name) {
  request.kind = name;
  return request;
}

/// Returns the drivers in files of their own, as kinds that `auto` never selects.
std::vector<std::string> listForeignDrivers() {
  std::vector<std::string> names;
  for (const std::string& name : listDriverFiles(driverFolders())) {
    const auto kinds = deviceKinds();
    if (std::none_of(kinds.begin(), kinds.end(),
                     [&](const DeviceKind& kind) { return name == kind.name; }))
      names.push_back(name);
  }
  return names;
}

std::string listOne(const DeviceKind& kind, const DeviceRequest& request) {
  if (kind.list == nullptr) return "";
  try {
    std::string text;
    for (const std::string& line : kind.list(setKind(request, kind.name))) text += "; " + line;
    return text.empty() ? "; none was found: is it plugged in?" : text;
  } catch (const std::runtime_error& error) {
    return std::string("; ") + error.what();
  }
}

}  // namespace

std::vector<std::string> deviceNames() {
  std::vector<std::string> names;
  for (const DeviceKind& kind : deviceKinds()) names.emplace_back(kind.name);
  for (const std::string& name : listForeignDrivers()) names.push_back(name);
  return names;
}

std::unique_ptr<HapticDevice> openDevice(const std::string& name, const DeviceRequest& request) {
  for (const DeviceKind& kind : deviceKinds()) {
    const bool best = request.pointer == nullptr ? &kind == &deviceKinds().front()
                                                 : std::string_view(kind.name) == "mouse";
    if (name == kind.name || (name == "auto" && best))
      return kind.open(setKind(request, kind.name));
  }
  const auto names = deviceNames();
  if (std::find(names.begin(), names.end(), name) != names.end())
    return openHelperDevice(setKind(request, name));
  throw std::runtime_error("--device " + name + ": is not one of auto|" + join(names, "|"));
}

std::unique_ptr<HapticDevice> findDevice(const DeviceRequest& request) {
  for (const DeviceKind& kind : deviceKinds()) {
    if (kind.list == nullptr || !kind.by_itself) continue;
    const DeviceRequest its = setKind(request, kind.name);
    bool found = false;
    try {
      found = !kind.list(its).empty();
      if (found) return kind.open(its);
    } catch (const std::runtime_error& error) {
      // Without access nothing counts as plugged in; `list --devices` shows the reason.
      if (found)
        request.log(std::string("the client continues without this device: ") + error.what());
    }
  }
  return nullptr;
}

std::string listDevices(const DeviceRequest& request) {
  std::string text;
  for (const DeviceKind& kind : deviceKinds())
    text.append(kind.name).append(": ").append(kind.description).append(listOne(kind, request)) +=
        "\n";
  for (const std::string& name : listForeignDrivers()) {
    const DeviceKind kind{name.c_str(), "a driver of its own", openHelperDevice, listHelperDevices};
    text.append(name).append(": ").append(kind.description).append(listOne(kind, request)) += "\n";
  }
  return text;
}

}  // namespace hapticast::client
