// SPDX-License-Identifier: MIT
#include "client/desk/local_device.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "client/desk/first_check.hpp"

namespace hapticast::client {

namespace {

struct SelectedDevice {
  std::unique_ptr<HapticDevice> device;
  bool auto_detected = false;  // a real device that the user did not name
};

/// --device auto opens a real device if one answers; with --hand it opens the virtual one.
SelectedDevice selectDevice(const Settings& settings, const Clock& clock,
                            LatestValue<PointerTarget>* pointer) {
  const DeviceRequest request{.profile = settings.profile,
                              .hand = settings.hand,
                              .clock = clock,
                              .pointer = pointer,
                              .options = settings.device_options,
                              .log = [](const std::string& line) { spdlog::info("{}", line); }};
  const bool scripted = settings.device == "auto" && settings.hand_given;
  if (settings.device == "auto" && !scripted) {
    if (auto device = findDevice(request))
      return {.device = std::move(device), .auto_detected = true};
  }
  return {.device = openDevice(scripted ? "virtual" : settings.device, request)};
}

RendererSettings rendererSettings(const Settings& settings, const DeviceProfile& profile,
                                  bool is_auto_detected) {
  RendererSettings renderer;
  renderer.unconfirmed = is_auto_detected;
  renderer.profile = profile;
  renderer.method = settings.method;
  renderer.stiffness_limit_N_mm = settings.stiffness_limit_N_mm;
  renderer.surface =
      settings.method == Method::kThesis ? SurfaceKind::kPerturbed : settings.surface;
  return renderer;
}

}  // namespace

LocalDevice::LocalDevice(const Settings& settings, const Clock& clock, UserInterface& ui) {
  SelectedDevice selected = selectDevice(settings, clock, ui.pointer());
  device = std::move(selected.device);
  is_auto_detected = selected.auto_detected;
  ui.setDevice(device->profile(), followsPointer(*device));
  readCheck();
  if (!is_checked) requireConfirmation(*device, ui);
}

void LocalDevice::readCheck() {
  profile = device->profile();
  is_checked = applyStoredCheck(*device, profile);
}

void LocalDevice::createRenderer(const Settings& settings, UserInterface& ui) {
  readCheck();
  renderer_settings = rendererSettings(settings, profile, is_auto_detected);
  renderer =
      std::make_unique<HapticRenderer>(renderer_settings, pool, stream, ui.controls(), &reports);
}

}  // namespace hapticast::client
