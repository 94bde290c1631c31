// SPDX-License-Identifier: MIT
// Signs the frames of one run of the server (Ed25519), each once for all receivers: as datagrams,
// and as a message for TCP. Thread: any.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::server {

/// Signed datagrams of one frame, without the receivers' tokens.
using SignedDatagrams = std::shared_ptr<const std::vector<std::vector<std::uint8_t>>>;

/// Owns the key of one run of the server. The stream number identifies this run.
class FrameSigner {
 public:
  /// Creates a random key and a random stream number. Both are unpredictable.
  FrameSigner();

  /// Returns the signed datagrams of a frame, without the receivers' tokens. Returns null if the
  /// frame is too large for datagrams.
  [[nodiscard]] SignedDatagrams signDatagrams(const CodedFrame& frame);
  /// Returns the bytes of a signed message with the frame.
  [[nodiscard]] SharedBytes signMessage(const CodedFrame& frame);
  /// Writes stream number and key into `welcome`.
  void introduce(Welcome& welcome) const;

  [[nodiscard]] std::uint32_t stream() const { return stream_; }
  [[nodiscard]] const std::vector<std::uint8_t>& probe() const { return probe_; }

 private:
  std::mutex mutex_;  // of key_: the encoder's thread signs frames, the network's key frames
  SigningKey key_;
  std::uint32_t stream_;
  std::vector<std::uint8_t> probe_;
};

}  // namespace hapticast::server
