// SPDX-License-Identifier: MIT
// Signature of a frame that travels over TCP. The server signs each encoded frame once for all
// viewers (Ed25519, RFC 8032). The signed bytes are the number of the stream and the encoded frame,
// so a frame of another run of the server has no valid signature. Thread: any.
#pragma once

#include <cstdint>
#include <span>

#include "common/codec/coded_frame.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/signature.hpp"

namespace hapticast {

/// Returns the bytes of a message with `frame` and its signature by `key`. Requires valid content.
[[nodiscard]] SharedBytes encodeSigned(const CodedFrame& frame, std::uint32_t stream,
                                       SigningKey& key);

/// Returns true if the message in `bytes` is a frame of `stream` with a valid signature of the
/// owner of `key`. `bytes` are a message that decode() accepted.
[[nodiscard]] bool verifyFrame(std::span<const std::uint8_t> bytes, std::uint32_t stream,
                               const VerifyingKey& key);

}  // namespace hapticast
