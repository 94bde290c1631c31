// SPDX-License-Identifier: MIT
// Signs the frames of one run of the server (Ed25519), each once for all receivers: as datagrams,
// and as a message for TCP. Thread: any.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/signature.hpp"
#include "server/stream/stage_time.hpp"
#include "server/stream/stream_identity.hpp"

namespace hapticast::server {

/// Signed datagrams of one frame, without the receivers' tokens.
using SignedDatagrams = std::shared_ptr<const std::vector<std::vector<std::uint8_t>>>;

/// Owns the key of one run of the server. The stream number identifies this run.
class FrameSigner {
 public:
  /// Signs with `key`, under a random stream number. Without a key it creates a random one. Random
  /// values are unpredictable.
  explicit FrameSigner(SigningKey key = SigningKey());

  /// Returns the signed datagrams of a frame, without the receivers' tokens. Returns null if the
  /// frame is too large for datagrams.
  [[nodiscard]] SignedDatagrams signDatagrams(const CodedFrame& frame);
  /// Returns the bytes of a signed message with the frame.
  [[nodiscard]] SharedBytes signMessage(const CodedFrame& frame);
  /// Returns the signature of `bytes`, which are no frame (messages to edges).
  [[nodiscard]] Signature sign(std::span<const std::uint8_t> bytes);
  /// Returns what viewers need to recognise the frames.
  [[nodiscard]] const StreamIdentity& identity() const { return identity_; }

  /// Measures the time of signatures from now on. Call it before the first one. `clock` must
  /// outlive this object.
  void measure(const Clock& clock) { clock_ = &clock; }
  /// Returns the time of all signatures of frames; 0 without measure().
  [[nodiscard]] StageTime signingTime() const;

 private:
  [[nodiscard]] LocalTime now() const { return clock_ != nullptr ? clock_->now() : LocalTime(); }
  /// Adds the time of the signatures since `begin`.
  void addTime(LocalTime begin);

  std::mutex mutex_;  // of key_: the encoder's thread signs frames, the network's key frames
  SigningKey key_;
  StreamIdentity identity_;
  const Clock* clock_ = nullptr;  // null: no measurement
  std::atomic<std::int64_t> signing_ns_{0};
  std::atomic<std::uint64_t> signings_{0};
};

}  // namespace hapticast::server
