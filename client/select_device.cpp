// SPDX-License-Identifier: MIT
#include "client/select_device.hpp"

#include <spdlog/spdlog.h>

#include <utility>

namespace hapticast::client {

SelectedDevice selectDevice(const Settings& settings, const Clock& clock,
                            LatestValue<PointerTarget>* pointer) {
  const DeviceRequest request{.profile = settings.profile,
                              .hand = settings.hand,
                              .clock = clock,
                              .pointer = pointer,
                              .falcon = settings.falcon,
                              .log = [](const std::string& line) { spdlog::info("{}", line); }};
  const bool scripted = settings.device == "auto" && settings.hand_given;
  if (settings.device == "auto" && !scripted) {
    if (auto device = findDevice(request))
      return {.device = std::move(device), .auto_detected = true};
  }
  return {.device = openDevice(scripted ? "virtual" : settings.device, request)};
}

}  // namespace hapticast::client
