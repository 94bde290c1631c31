// SPDX-License-Identifier: MIT
// Log-linear histogram of durations. Each octave (power of two) has 16 buckets of equal width, so
// the resolution is 6 %. Adding a value needs constant time. The histogram has a constant size and
// uses no heap. Thread: one, the owner.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace hapticast {

/// Histogram of values in ns.
class Histogram {
 public:
  /// Adds a value. A negative value counts as 0. Thread: the owner; other threads receive copies.
  void add(std::int64_t value_ns) noexcept {
    const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(value_ns, 0));
    ++buckets_[bucketIndex(value)];
    ++count_;
    max_ns_ = std::max(max_ns_, value);
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t max_ns() const noexcept { return max_ns_; }

  /// Returns the q-quantile in ns: the upper end of its bucket, but at most max_ns(). Returns 0 if
  /// the histogram is empty. Requires 0 <= q <= 1.
  [[nodiscard]] std::uint64_t quantile_ns(double q) const noexcept {
    if (count_ == 0) return 0;
    const auto rank = static_cast<std::uint64_t>(q * static_cast<double>(count_ - 1)) + 1;
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < buckets_.size(); ++i) {
      seen += buckets_[i];
      if (seen >= rank) return std::min(upperEdge(i), max_ns_);
    }
    return max_ns_;
  }

 private:
  static constexpr unsigned kSubBits = 4;
  static constexpr std::size_t kSub = 1U << kSubBits;

  static std::size_t bucketIndex(std::uint64_t value) noexcept {
    if (value < kSub) return static_cast<std::size_t>(value);
    const auto octave = static_cast<unsigned>(std::bit_width(value)) - 1 - kSubBits;
    return (octave + 1) * kSub + static_cast<std::size_t>((value >> octave) & (kSub - 1));
  }
  static std::uint64_t upperEdge(std::size_t bucket) noexcept {
    if (bucket < kSub) return bucket;
    const auto octave = static_cast<unsigned>(bucket / kSub - 1);
    return ((kSub + bucket % kSub + 1) << octave) - 1;
  }

  // 60 octaves above the first 16 values cover 64 bits.
  std::array<std::uint64_t, (64 - kSubBits + 1) * kSub> buckets_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ns_ = 0;
};

}  // namespace hapticast
