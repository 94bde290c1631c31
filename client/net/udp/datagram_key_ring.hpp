// SPDX-License-Identifier: MIT
// Keys of the sealed datagrams of one stream, on the client's side (proto/datagrams.md). Each key
// has an expiry time, and a sliding window of the counters of the datagrams that it has opened
// (replay protection as in RFC 6479). So the client opens no sealed datagram twice. Times are
// arguments. Thread: network.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/time.hpp"
#include "common/transport/datagram.hpp"
#include "common/transport/seal.hpp"

namespace hapticast::client {

/// Sliding window over the last kCounters counters. It has one bit for each counter that was added.
class CounterWindow {
 public:
  /// Size of the window. The value is a choice: the fragments of four frames of 8 MiB, so that all
  /// sends of a datagram lie in it.
  static constexpr std::uint64_t kCounters = 32'768;

  /// Returns true if `counter` was added, or if it is too old for the window.
  [[nodiscard]] bool has(std::uint64_t counter) const noexcept;
  /// Registers `counter`. Requires !has(counter).
  void add(std::uint64_t counter) noexcept;

 private:
  static constexpr std::uint64_t kWordBits = 64;
  /// One word more than the window has, so that the newest word can be incomplete.
  static constexpr std::uint64_t kWords = kCounters / kWordBits + 1;

  std::array<std::uint64_t, kWords> words_{};
  std::uint64_t newest_ = 0;
};

/// The keys of one stream.
class DatagramKeyRing {
 public:
  /// Largest number of keys. The oldest one is dropped. An hourly rotation needs two.
  static constexpr std::size_t kMostKeys = 4;

  /// Begins a stream. `key` is the key from the server's welcome message. If it is nullopt, the
  /// datagrams of the stream are not sealed. All older keys are removed. If the client reconnects
  /// and `key` is still the newest key, the ring retains its window of received counters. So
  /// repeated datagrams stay rejected. Throws std::runtime_error if OpenSSL fails.
  void begin(const std::optional<DatagramKey>& key);
  /// Adds a new key of the stream. The earlier keys expire after `key.grace`, unless they expire
  /// sooner. Throws std::runtime_error if OpenSSL fails.
  void add(const DatagramKey& key, LocalTime now);
  /// Returns true if datagrams with frames must be sealed.
  [[nodiscard]] bool sealed() const { return !keys_.empty(); }

  /// Result of check().
  enum class Check : std::uint8_t {
    kOpenable,  ///< its key is valid and its counter is new, or it is not sealed
    kRepeated,  ///< its counter has already arrived, or is too old
    kNoKey,     ///< its key is unknown or expired, or a required seal is missing
  };
  /// Checks the key and the counter of a datagram. It is cheap and changes nothing, so call it
  /// before the signature is verified.
  [[nodiscard]] Check check(const Datagram& datagram, LocalTime now) const;
  /// Decrypts a datagram and sets its payload. Requires the result kOpenable and a valid signature.
  /// Returns false if the authentication tag is wrong. The payload is valid until the next call.
  [[nodiscard]] bool open(Datagram& datagram);

 private:
  struct Entry {
    explicit Entry(const DatagramKey& key) : of(key), opening(key.bytes) {}
    DatagramKey of;
    OpeningKey opening;
    CounterWindow window;
    std::optional<LocalTime> expires;
  };

  /// Returns the index of the key `id`; the number of keys if there is none.
  [[nodiscard]] std::size_t find(std::uint8_t id) const;

  std::vector<Entry> keys_;  // the oldest first; empty: datagrams are not sealed
  std::array<std::uint8_t, kMostDatagramBytes> payload_{};
};

}  // namespace hapticast::client
