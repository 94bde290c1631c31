// SPDX-License-Identifier: MIT
// Makes a frame's datagrams, signed once for all who get them. Thread: one that signs (the
// encoder's); what is constant, any.
#pragma once

#include <cstdint>
#include <vector>

#include "common/protocol/fragment.hpp"
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

class DatagramSigner {
 public:
  /// A key and a number of this run of the server, which nobody can guess.
  DatagramSigner();

  /// Null where the frame is too large for datagrams.
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
