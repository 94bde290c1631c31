// SPDX-License-Identifier: MIT
// Identity of a signed stream: the data with which viewers verify its frames. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::server {

/// Stream number and verifying key of the server run that signs the frames.
struct StreamIdentity {
  std::uint32_t stream = 0;         ///< number of this run, in every datagram and signature
  KeyBytes verifying_key{};         ///< key with which viewers verify the signatures
  std::vector<std::uint8_t> probe;  ///< signed body of a probe, without a token
  bool sealed = false;              ///< whether all datagrams with frames are sealed
  /// Newest key of the sealed datagrams. nullopt: they are not sealed, or they are and this server
  /// lacks the key. Then it sends frames by TCP only.
  std::optional<DatagramKey> datagram_key = std::nullopt;
};

}  // namespace hapticast::server
