// SPDX-License-Identifier: MIT
// Sequence lock: passes the newest value of one writer to any number of readers, also between two
// processes that share the memory. The writer never waits. A reader repeats a read during which the
// writer has changed the value, a bounded number of times.
// Thread: one writer, any readers.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace hapticast {

/// The newest value of type T. All bytes zero is a valid initial state: the value T{} of a T whose
/// members are zero.
template <class T>
class SeqLock {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(std::uint64_t) == 0);
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

 public:
  /// Stores a value, which replaces the one before. Thread: the writer.
  void store(const T& value) noexcept {
    std::array<std::uint64_t, kWords> words;
    std::memcpy(words.data(), &value, sizeof(T));
    const std::uint32_t version = version_.load(std::memory_order_relaxed);
    version_.store(version + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_relaxed);
    version_.store(version + 2, std::memory_order_release);
  }

  /// Copies the newest value to `value`. Returns false, and leaves `value` as it is, if the writer
  /// has changed the value during each of the attempts, or died within a store().
  bool load(T& value) const noexcept {
    constexpr int kAttempts = 100;  // a store lasts far less than as many reads
    for (int i = 0; i < kAttempts; ++i) {
      const std::uint32_t before = version_.load(std::memory_order_acquire);
      std::array<std::uint64_t, kWords> words;
      for (std::size_t w = 0; w < kWords; ++w) words[w] = words_[w].load(std::memory_order_relaxed);
      std::atomic_thread_fence(std::memory_order_acquire);
      if (before % 2 != 0 || version_.load(std::memory_order_relaxed) != before) continue;
      std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
      return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kWords = sizeof(T) / sizeof(std::uint64_t);
  std::atomic<std::uint32_t> version_{0};  // odd while the writer stores
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace hapticast
