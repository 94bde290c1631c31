// SPDX-License-Identifier: MIT
// Signs the frames of one run of the server (Ed25519), each once for all receivers: as datagrams,
// and as a message for TCP. A server with TLS also seals the datagrams. Thread: any, except where a
// function states another one.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/signature.hpp"
#include "server/stream/datagram_sealer.hpp"
#include "server/stream/stage_time.hpp"
#include "server/stream/stream_identity.hpp"

namespace hapticast::server {

/// Signed datagrams of one frame, without the receivers' tokens.
using SignedDatagrams = std::shared_ptr<const std::vector<std::vector<std::uint8_t>>>;

/// Owns the key of one run of the server. The stream number identifies this run.
class FrameSigner {
 public:
  /// Creates a signer with `key` and a random stream number. The default is a random key. Random
  /// values are unpredictable. `sealer`: seals all datagrams; null: they are not sealed.
  explicit FrameSigner(SigningKey key = SigningKey(),
                       std::unique_ptr<DatagramSealer> sealer = nullptr);

  /// Replaces the key of sealed datagrams if its time is over (DatagramSealer::rotate()). Returns a
  /// key that viewers must receive before the next frame. Thread: the encoder's.
  [[nodiscard]] std::optional<DatagramKey> rotateKey();
  /// Replaces the key of sealed datagrams before the next frame, because some viewers are no longer
  /// permitted to read the stream (DatagramSealer::revoke()). Does nothing if datagrams are not
  /// sealed.
  void revokeKey();
  /// Returns the signed datagrams of a frame, without the receivers' tokens. Returns null if the
  /// frame is too large for datagrams. Thread: the encoder's.
  [[nodiscard]] SignedDatagrams signDatagrams(const CodedFrame& frame);
  /// Returns the bytes of a signed message with the frame.
  [[nodiscard]] SharedBytes signMessage(const CodedFrame& frame);
  /// Returns the signature of `bytes`, a message to edges.
  [[nodiscard]] Signature sign(std::span<const std::uint8_t> bytes);
  /// Returns the data with which viewers verify the frames, and the first key of sealed datagrams.
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
  std::unique_ptr<DatagramSealer> sealer_;  // null: datagrams are not sealed
  StreamIdentity identity_;
  const Clock* clock_ = nullptr;  // null: no measurement
  std::atomic<std::int64_t> signing_ns_{0};
  std::atomic<std::uint64_t> signings_{0};
};

}  // namespace hapticast::server
