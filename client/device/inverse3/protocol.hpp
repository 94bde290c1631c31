// SPDX-License-Identifier: MIT
// Messages of the Haply Inverse service: JSON over a WebSocket. The service answers each message of
// the client with one state of all devices. The service applies a force for only one of its own
// ticks, so the force ends when the client sends no more messages. The service's frame is X right,
// Y forward, Z up, in m. The functions convert to the device frame in mm.
// Thread: any (pure functions).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast::client {

/// Key of the force in a message: services since 3.5 name it `vector`, older ones `values`.
enum class Inverse3ForceKey : std::uint8_t { kVector, kValues };

/// One device in a message of the service.
struct Inverse3Device {
  std::string id;
  std::string type;                 ///< "inverse3" or "minverse"; empty: not stated
  std::optional<Vec3> position_mm;  ///< device frame; nullopt: missing or not finite
  bool calibrated = true;
  bool filtered = false;  ///< the service filters forces or adds damping
};

/// A message of the service.
struct Inverse3Message {
  std::vector<Inverse3Device> devices;
  std::uint32_t buttons = 0;  ///< of the first grip: bits 0, 1 and 2 are a, b and c
  std::string version;        ///< of the service; empty: not stated
  bool has_session = false;   ///< the message names a session (services since 3.5)
};

/// Parses a message of the service. Returns nullopt if it is no JSON object. Members of another
/// form than expected count as absent.
std::optional<Inverse3Message> parseInverse3(std::string_view text);

/// Returns the key for a service that sent `message` first.
Inverse3ForceKey selectForceKey(const Inverse3Message& message);

/// Returns the first message of a session: the profile of the program, the preset and the frame of
/// the device `id`.
std::string toSessionMessage(const std::string& id, const std::string& preset);

/// Returns the message that commands `force_N` (device frame) to the device `id`.
std::string toForceMessage(const std::string& id, Inverse3ForceKey key, const Vec3& force_N);

}  // namespace hapticast::client
