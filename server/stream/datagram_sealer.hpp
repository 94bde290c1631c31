// SPDX-License-Identifier: MIT
// Keys of the sealed datagrams of one run of the server (proto/datagrams.md). Each key is random. A
// new key replaces the present one every hour, and after revoke(). Viewers receive each new key
// before the first datagram that it seals. Thread: see each function.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "common/protocol/messages.hpp"
#include "common/time.hpp"
#include "common/transport/seal.hpp"

namespace hapticast::server {

/// Owns the present key and the next one.
class DatagramSealer {
 public:
  /// Time after which a key is replaced.
  static constexpr Duration kKeyLife = std::chrono::hours(1);
  /// Time from the announcement of a new key to its first use. Viewers receive the key over TCP. In
  /// this time the key arrives even on a slow connection. After revoke() the time is zero.
  static constexpr Duration kAnnouncedBefore = std::chrono::seconds(1);
  /// Time after the announcement in which viewers still accept datagrams of the previous key.
  static constexpr Duration kGrace = std::chrono::seconds(10);
  /// The same time after revoke(). It covers datagrams that are in transit, and their copies.
  static constexpr Duration kRevokedGrace = std::chrono::seconds(1);

  /// Creates the first key. `clock` must outlive the object. Throws std::runtime_error if the
  /// system has no random numbers.
  explicit DatagramSealer(const Clock& clock);

  /// Replaces the key if its time is over. Returns a new key that the caller must send to viewers
  /// before the next frame, at most once for each key; otherwise nullopt. Call it before each
  /// frame. Thread: the encoder's.
  [[nodiscard]] std::optional<DatagramKey> rotate();
  /// Replaces the key at the next rotate(), which uses the new key at once. Call it after the
  /// sessions of the revoked viewers have begun to close, because all open sessions receive the new
  /// key. Thread: any.
  void revoke();
  /// Returns the present key. Thread: the encoder's.
  [[nodiscard]] SealingKey& key() { return present_; }
  /// Returns the first key, for the first viewers. Thread: any, before the first rotate().
  [[nodiscard]] DatagramKey firstKey() const { return {present_.id(), present_.bytes(), kGrace}; }

 private:
  [[nodiscard]] SealingKey makeKey();

  const Clock& clock_;
  SealingKey present_;
  LocalTime used_since_;
  std::optional<SealingKey> next_;  // announced
  LocalTime use_next_at_;
  std::uint8_t last_id_;
  std::mutex mutex_;
  bool revoked_ = false;  // guarded by mutex_
};

}  // namespace hapticast::server
