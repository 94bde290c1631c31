// SPDX-License-Identifier: MIT
// Messages sent through the wire, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <utility>

#include "common/protocol/messages.hpp"
#include "tests/support/coded.hpp"

namespace hapticast::testing {

/// The received form of a sent message.
template <class T>
T roundTrip(const T& message) {
  auto decoded = decode(encode(message));
  if (!decoded.ok()) throw std::runtime_error(decoded.error().message);
  return std::get<T>(std::move(decoded).value());
}

/// The received form of a frame; its reliefs are slices.
inline CodedFrame roundTrip(const HapticFrame& frame) { return roundTrip(coded(frame)); }

/// The error that a message gives at the other side; fails the test when it is taken.
inline ErrorCode refusal(const Message& message) {
  const auto decoded = decode(encode(message));
  if (decoded.ok()) throw std::runtime_error("was accepted");
  EXPECT_FALSE(decoded.error().message.empty());
  return decoded.error().code;
}

inline ErrorCode refusal(const HapticFrame& frame) { return refusal(Message(coded(frame))); }

inline Relief randomRelief(PixelRect rect, std::uint32_t seed, float height_mm) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> height(0.0F, height_mm);
  Relief relief{rect, {}, {}};
  const std::size_t pixels = rect.pixels();
  for (std::size_t i = 0; i < pixels; ++i) {
    relief.mask.push_back(i == 0 || random() % 3 != 0 ? 1 : 0);
    relief.height_mm.push_back(relief.mask.back() != 0 ? height(random) : 0.0F);
  }
  return relief;
}

}  // namespace hapticast::testing
