// SPDX-License-Identifier: MIT
// Adaptive binary range coder (Martin 1979) with probability models for bits and integers. A model
// adapts its probability to the bits that were coded with it.
//
// Encoder and decoder have the same two operations, `bit(model, value)` and `raw(value)`. The
// encoder writes `value` and returns it. The decoder ignores `value` and returns the decoded bit.
// So one template with the coder as a parameter can encode and decode. "To code" means to encode or
// to decode. Thread: any.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace hapticast::codec {

/// Adaptive probability of a bit. The first bits change it more than later ones.
struct BitModel {
  std::uint16_t zero = 32768;  ///< probability of 0, in 1/65536
  std::uint8_t seen = 0;       ///< number of coded bits, at most kMostSeen
};

inline constexpr unsigned kMostSeen = 32;
/// Rate of adaptation, by the number of coded bits. It is the share of the difference between
/// probability and bit that one bit removes, in 1/65536.
inline constexpr auto kRates = [] {
  std::array<std::uint16_t, kMostSeen + 1> rates{};
  for (unsigned n = 0; n <= kMostSeen; ++n)
    rates[n] = static_cast<std::uint16_t>(655360 / (10 * n + 16));
  return rates;
}();

/// Moves the probability of the model towards the bit `one`. The probability remains within limits
/// that exclude 0 and 1.
inline void update(BitModel& model, bool one) noexcept {
  constexpr unsigned kLeast = 96;
  constexpr unsigned kMost = 65440;
  const unsigned rate = kRates[model.seen];
  unsigned zero = model.zero;
  zero = one ? zero - (zero * rate >> 16U) : zero + ((65535U - zero) * rate >> 16U);
  zero = zero < kLeast ? kLeast : zero;
  model.zero = static_cast<std::uint16_t>(zero > kMost ? kMost : zero);
  model.seen = static_cast<std::uint8_t>(model.seen + (model.seen < kMostSeen ? 1 : 0));
}

inline constexpr std::uint32_t kLeastRange = 1U << 24U;
/// Largest number of trailing zero bytes that an encoder omits. If a decoder has to read beyond
/// these bytes, its input is invalid.
inline constexpr std::size_t kMostZerosDropped = 16;

/// Decoder for the bytes of one slice.
class RangeDecoder {
 public:
  static constexpr bool kDecodes = true;

  explicit RangeDecoder(std::span<const std::uint8_t> bytes) noexcept
      : next_(bytes.data()), end_(bytes.data() + bytes.size()) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8U | byte();
  }

  /// Decodes a bit with its model, which then adapts.
  bool bit(BitModel& model, bool /*value*/ = false) noexcept {
    const bool one = decide(model.zero >> 1U);
    update(model, one);
    return one;
  }

  /// Decodes a bit with the mean probability of two models. Both models then adapt.
  bool bit(BitModel& model, BitModel& other, bool /*value*/ = false) noexcept {
    const bool one = decide((std::uint32_t{model.zero} + other.zero) >> 2U);
    update(model, one);
    update(other, one);
    return one;
  }

  /// Decodes a bit of probability 1/2, without a model.
  bool raw(bool /*value*/ = false) noexcept {
    range_ >>= 1U;
    const bool one = code_ >= range_;
    if (one) code_ -= range_;
    refill();
    return one;
  }

  /// Returns true if the decoder has read beyond the zero bytes that an encoder omits. The slice is
  /// then incomplete.
  [[nodiscard]] bool isMisled() const noexcept { return beyond_ > kMostZerosDropped + 4; }

 private:
  /// Decodes a bit that is 0 with the probability `zero`, in 1/32768.
  bool decide(std::uint32_t zero) noexcept {
    const std::uint32_t bound = (range_ >> 15U) * zero;
    const bool one = code_ >= bound;
    if (one) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    refill();
    return one;
  }
  void refill() noexcept {
    while (range_ < kLeastRange) {
      range_ <<= 8U;
      code_ = code_ << 8U | byte();
    }
  }
  std::uint32_t byte() noexcept {
    if (next_ != end_) return *next_++;
    ++beyond_;
    return 0;
  }

  const std::uint8_t* next_;
  const std::uint8_t* end_;
  std::size_t beyond_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
  std::uint32_t code_ = 0;
};

/// Encoder for the bytes of one slice.
class RangeEncoder {
 public:
  static constexpr bool kDecodes = false;

  /// Appends bytes to `out` until finish(). `out` must outlive the encoder.
  explicit RangeEncoder(std::vector<std::uint8_t>& out) noexcept : out_(out) {}

  /// Encodes a bit with its model, which then adapts.
  bool bit(BitModel& model, bool one) {
    write(model.zero >> 1U, one);
    update(model, one);
    return one;
  }

  /// Encodes a bit with the mean probability of two models. Both models then adapt.
  bool bit(BitModel& model, BitModel& other, bool one) {
    write((std::uint32_t{model.zero} + other.zero) >> 2U, one);
    update(model, one);
    update(other, one);
    return one;
  }

  /// Encodes a bit of probability 1/2, without a model.
  bool raw(bool one) {
    range_ >>= 1U;
    if (one) low_ += range_;
    refill();
    return one;
  }

  /// Writes the last bytes: the shortest number inside the range of the coder. Omits at most
  /// kMostZerosDropped trailing zero bytes. Call it once, at the end.
  void finish() {
    const std::size_t begin = out_.size();
    for (unsigned bits = 32; bits > 0; --bits) {
      const std::uint64_t step = std::uint64_t{1} << (bits - 1);
      const std::uint64_t end = (low_ + step - 1) / step * step;
      if (end - low_ >= range_) continue;
      low_ = end;
      break;
    }
    for (int i = 0; i < 5; ++i) shift();
    std::size_t dropped = 0;
    while (out_.size() > begin && out_.back() == 0 && dropped < kMostZerosDropped) {
      out_.pop_back();
      ++dropped;
    }
  }

 private:
  void write(std::uint32_t zero, bool one) {
    const std::uint32_t bound = (range_ >> 15U) * zero;
    if (one) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    refill();
  }
  void refill() {
    while (range_ < kLeastRange) {
      range_ <<= 8U;
      shift();
    }
  }
  /// Outputs the top byte of low_. A carry may still change a byte, and the 0xFF bytes after it.
  /// Such bytes wait.
  void shift() {
    constexpr std::uint64_t kCarry = std::uint64_t{1} << 32U;
    if (low_ < 0xFF000000U || low_ >= kCarry) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32U);
      if (!first_) out_.push_back(static_cast<std::uint8_t>(waiting_ + carry));
      first_ = false;
      for (; pending_ > 0; --pending_) out_.push_back(static_cast<std::uint8_t>(0xFFU + carry));
      waiting_ = static_cast<std::uint8_t>(low_ >> 24U);
    } else {
      ++pending_;
    }
    low_ = (low_ & 0xFFFFFFU) << 8U;
  }

  std::vector<std::uint8_t>& out_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
  std::size_t pending_ = 0;
  std::uint8_t waiting_ = 0;
  bool first_ = true;  ///< true until the first byte, which has no carry
};

inline constexpr int kMostExponent = 22;
inline constexpr int kPlaceExponents = 8;

/// Models for the bits of an integer. They code whether the integer is zero, its sign, its exponent
/// (in unary), and the highest bit of its mantissa.
struct NumberModel {
  BitModel zero, sign;
  std::array<BitModel, kMostExponent + 1> exponent, mantissa;
};

/// Additional models of an integer, selected by the integer's position. They code whether it is
/// zero, and the first bits of its exponent.
struct PlaceModel {
  BitModel zero;
  std::array<BitModel, kPlaceExponents> exponent;
};

/// Encodes or decodes a number of at least 1, as an Elias gamma code with models. Returns the
/// number, which has at most kMostExponent + 1 bits. `place` has additional models; null means that
/// there are none.
template <class Coder>
int codeMagnitude(Coder& coder, NumberModel& model, PlaceModel* place, int value) {
  const int wanted = Coder::kDecodes ? 0 : std::bit_width(static_cast<unsigned>(value)) - 1;
  int exponent = 0;
  for (; exponent < kMostExponent; ++exponent) {
    const auto i = static_cast<std::size_t>(exponent);
    const bool both = place != nullptr && exponent < kPlaceExponents;
    if (!(both ? coder.bit(model.exponent[i], place->exponent[i], exponent < wanted)
               : coder.bit(model.exponent[i], exponent < wanted)))
      break;
  }
  unsigned out = 1;
  for (int i = exponent - 1; i >= 0; --i) {
    const bool one = (static_cast<unsigned>(value) >> static_cast<unsigned>(i) & 1U) != 0;
    BitModel& second = model.mantissa[static_cast<std::size_t>(exponent)];
    const bool read = i == exponent - 1 ? coder.bit(second, one) : coder.raw(one);
    out = out << 1U | (read ? 1U : 0U);
  }
  return static_cast<int>(out);
}

/// Encodes or decodes a number of either sign, and returns it.
template <class Coder>
int codeNumber(Coder& coder, NumberModel& model, int value) {
  if (!coder.bit(model.zero, value != 0)) return 0;
  const bool minus = coder.bit(model.sign, value < 0);
  const int magnitude = codeMagnitude(coder, model, nullptr, std::abs(value));
  return minus ? -magnitude : magnitude;
}

}  // namespace hapticast::codec
