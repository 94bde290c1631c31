// SPDX-License-Identifier: MIT
// Numbers drawn from a seed, the same on every machine. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hapticast::evaluate::held {

class Draw {
 public:
  explicit Draw(std::uint64_t seed)
      : state_(seed * 0x9E3779B97F4A7C15ULL + 0x2545F4914F6CDD1DULL) {}

  /// Evenly in [low, high).
  double between(double low, double high) { return low + (high - low) * unit(); }
  std::size_t oneOf(std::size_t count) {
    return static_cast<std::size_t>(unit() * static_cast<double>(count));
  }
  bool chance(double share) { return unit() < share; }

 private:
  // A splitmix step: a Weyl sequence, well mixed.
  double unit() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1.0p-53;
  }

  std::uint64_t state_;
};

}  // namespace hapticast::evaluate::held
