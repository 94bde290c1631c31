// SPDX-License-Identifier: MIT
// Identity of a signed stream: what viewers need to recognise its frames. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

#include "common/transport/signature.hpp"

namespace hapticast::server {

/// The number and the key of one run of the server that signs the frames.
struct StreamIdentity {
  std::uint32_t stream = 0;         ///< number of this run, in every datagram and signature
  KeyBytes verifying_key{};         ///< key with which viewers verify the signatures
  std::vector<std::uint8_t> probe;  ///< signed body of a probe, without a token
};

}  // namespace hapticast::server
