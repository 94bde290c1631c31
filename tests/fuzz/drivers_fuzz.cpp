// SPDX-License-Identifier: MIT
// Data from drivers to the client: messages of a helper process, readings in the shared page,
// and messages of the Inverse service. Any bytes are accepted or refused. What comes out is one
// line, or a finite position within the workspace.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "client/device/helper/driver_profile.hpp"
#include "client/device/helper/messages.hpp"
#include "client/device/helper/state_check.hpp"
#include "client/device/inverse3/protocol.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::drivers {
namespace {

using namespace hapticast::client;

bool isLine(const std::string& text) {
  return std::none_of(text.begin(), text.end(), [](char each) {
    return static_cast<unsigned char>(each) < 0x20 || each == 0x7F;
  });
}

void readMessage(std::string_view bytes) {
  const auto message = parseMessage(bytes);
  if (!message) return;
  require(isLine(message->text) && isLine(message->problem));
  const PlantProfile profile = convertProfile("x", message->profile, "");
  require(profile.mass_kg > 0.0 && profile.mass_kg <= 1.0);
  require(profile.peak_N > 0.0 && profile.peak_N <= 20.0);
  require(profile.continuous_N <= profile.peak_N && profile.workspace_mm.allFinite());
  require(profile.delay_ticks >= 0 && profile.delay_ticks <= 5);
}

void checkReadings(std::string_view bytes) {
  StateCheck check({160.0, 120.0, 70.0});
  const hapticast::LocalTime now{hapticast::Duration(1'000'000'000)};
  for (DeviceReading reading; bytes.size() >= sizeof reading; bytes.remove_prefix(sizeof reading)) {
    std::memcpy(static_cast<void*>(&reading), bytes.data(), sizeof reading);
    const DeviceState state = check.check(reading, now);
    require(state.position_mm.allFinite() && state.position_mm.cwiseAbs().maxCoeff() <= 240.0);
    require(state.status != DeviceStatus::kOk || state.time <= now);
  }
}

}  // namespace

HAPTICAST_FUZZ_TARGET("drivers") {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  readMessage(bytes.substr(0, kLongestMessage_bytes));
  checkReadings(bytes);
  if (const auto message = parseInverse3(bytes)) {
    require(message->devices.size() <= 16 && message->buttons < 8);
    (void)selectForceKey(*message);
  }
  return 0;
}

}  // namespace hapticast::fuzz::drivers
