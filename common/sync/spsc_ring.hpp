// SPDX-License-Identifier: MIT
// Single-producer single-consumer ring buffer (Lamport queue) of plain values. Neither side ever
// waits. Thread: one producer, one consumer.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace hapticast {

/// Ring buffer for `Capacity` values. Capacity is a power of two.
template <class T, std::size_t Capacity>
class SpscRing {
  // T owns no memory, so copies in the loop cannot allocate. (Eigen vectors are not trivially
  // copyable.)
  static_assert(std::is_trivially_destructible_v<T>);
  static_assert((Capacity & (Capacity - 1)) == 0 && Capacity > 1);

 public:
  /// Appends a value. If the ring is full, returns false and changes nothing. Thread: the producer.
  [[nodiscard]] bool tryPush(const T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    // Pairs with the release store in tryPop: the slot's old value has been read.
    if (head - tail_.load(std::memory_order_acquire) == Capacity) return false;
    slots_[head & (Capacity - 1)] = value;
    // Pairs with the acquire load in tryPop: publishes the slot.
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Removes the oldest value and writes it to `value`. Returns false if the ring is empty. Thread:
  /// the consumer.
  [[nodiscard]] bool tryPop(T& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (head_.load(std::memory_order_acquire) == tail) return false;
    value = slots_[tail & (Capacity - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, Capacity> slots_{};
  alignas(64) std::atomic<std::size_t> head_{0};  // written by the producer only
  alignas(64) std::atomic<std::size_t> tail_{0};  // written by the consumer only
};

}  // namespace hapticast
