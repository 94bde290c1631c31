// SPDX-License-Identifier: MIT
// Opens the virtual device of a request, with its scripted hand.
#include <stdexcept>
#include <utility>

#include "client/device/device_request.hpp"
#include "client/device/open_device.hpp"
#include "client/device/virtual/virtual_device.hpp"

namespace hapticast::client {

namespace {

std::vector<HandTarget> readTargets(const std::string& file) {
  try {
    return loadHandTargets(file);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("--hand ") + error.what());
  }
}

HandScript handScript(const std::string& name, const HandStiffness& stiffness) {
  if (name == "press") return {HandKind::kPress, stiffness};
  if (name == "slide") return {HandKind::kSlide, stiffness};
  if (name == "follow") return {HandKind::kFollow, stiffness};
  return {HandKind::kFile, stiffness, readTargets(name)};
}

}  // namespace

std::unique_ptr<HapticDevice> openVirtual(const DeviceRequest& request) {
  const PlantProfile profile = loadProfile(request.profile);
  if (request.hand == kFreeGrip)
    return std::make_unique<VirtualDevice>(profile, Hand::none(), request.clock);
  const HandStiffness stiffness{.hand_N_mm = Hand::light().stiffness_N_m * 1e-3,
                                .surface_N_mm = profile.stiffness_N_mm};
  HandScript script = handScript(request.hand, stiffness);
  auto device = std::make_unique<VirtualDevice>(profile, Hand::light(), request.clock);
  device->lead(std::move(script), request.hand);
  return device;
}

}  // namespace hapticast::client
