// SPDX-License-Identifier: MIT
// Signs a frame's datagrams (Ed25519), once for all receivers. Thread: the encoder's for sign();
// any for the constant members.
#pragma once

#include <cstdint>
#include <vector>

#include "common/protocol/fragment.hpp"
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Key and stream number of one run of the server.
class DatagramSigner {
 public:
  /// Creates a random key and stream number, which are not predictable.
  DatagramSigner();

  /// Returns the signed datagrams without tokens; null if the frame is too large for datagrams.
  [[nodiscard]] SignedDatagrams sign(const CodedFrame& frame);

  [[nodiscard]] std::uint32_t stream() const { return stream_; }
  [[nodiscard]] const KeyBytes& verifyingKey() const { return key_.verifyingKey(); }
  [[nodiscard]] const std::vector<std::uint8_t>& probe() const { return probe_; }

 private:
  SigningKey key_;
  std::uint32_t stream_;
  std::vector<std::uint8_t> probe_;
};

}  // namespace hapticast::server
