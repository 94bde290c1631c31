// SPDX-License-Identifier: MIT
// Triple buffer: passes the newest value of one writer to one reader. Neither side ever waits, and
// the reader never receives a mixture of two values. Thread: one writer, one reader.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace hapticast {

/// The newest value of type T that the writer has stored.
template <class T>
class LatestValue {
  // T owns no memory, so copies in the loop cannot allocate. (Eigen vectors are not trivially
  // copyable.)
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  LatestValue() = default;
  explicit LatestValue(const T& initial) { slots_.fill(initial); }

  /// Stores a value, which replaces the one before. Thread: the writer.
  void store(const T& value) noexcept {
    slots_[back_] = value;
    // Release publishes the slot; acquire receives a slot that the reader has finished with (pairs
    // with load()).
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) &
            kIndex;
  }

  /// Returns the value that was stored last, or the initial one. The reference is valid until the
  /// next load(). Thread: the reader.
  [[nodiscard]] const T& load() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    }
    return slots_[front_];
  }

 private:
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::uint8_t kIndex = 3;
  std::array<T, 3> slots_{};
  std::uint8_t back_ = 0;                // writer only
  std::atomic<std::uint8_t> middle_{1};  // shared: slot index and the fresh bit
  std::uint8_t front_ = 2;               // reader only
};

}  // namespace hapticast
