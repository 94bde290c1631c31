// SPDX-License-Identifier: MIT
#include "client/web/ed25519.hpp"

#include <algorithm>
#include <cstddef>

#include "client/web/sha512.hpp"

namespace hapticast::client::ed25519 {

namespace {

constexpr int kLimbBits = 29;
constexpr std::uint64_t kLimb = (std::uint64_t{1} << kLimbBits) - 1;
constexpr std::uint64_t kFold = 19 << 6;  // 2^261 modulo p, because nine limbs have 261 bits
constexpr Field kZero{};
constexpr Field kOne{1};

/// Carries, so that each limb has 29 bits, except for a carry of the lowest one.
Field carry(Field a) {
  std::uint64_t over = 0;
  for (std::uint64_t& limb : a) {
    limb += over;
    over = limb >> kLimbBits;
    limb &= kLimb;
  }
  a[0] += over * kFold;
  a[1] += a[0] >> kLimbBits;
  a[0] &= kLimb;
  return a;
}

Field add(const Field& a, const Field& b) {
  Field sum;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = a[i] + b[i];
  return carry(sum);
}

Field subtract(const Field& a, const Field& b) {
  // 128 p has nine limbs that are larger than any limb of b.
  Field difference;
  for (std::size_t i = 0; i < difference.size(); ++i) {
    const std::uint64_t multiple = i == 0 ? 2 * kLimb + 2 - 2 * kFold : 2 * kLimb;
    difference[i] = a[i] + multiple - b[i];
  }
  return carry(difference);
}

Field multiply(const Field& a, const Field& b) {
  std::array<std::uint64_t, 18> product{};
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t k = 0; k < 9; ++k) product[i + k] += a[i] * b[k];
  for (std::size_t i = 0; i + 1 < product.size(); ++i) {
    product[i + 1] += product[i] >> kLimbBits;
    product[i] &= kLimb;
  }
  Field folded;
  for (std::size_t i = 0; i < 9; ++i) folded[i] = product[i] + product[i + 9] * kFold;
  return carry(folded);
}

Field square(const Field& a) { return multiply(a, a); }

/// Returns a to the power of 2^252 - 3.
Field power252m3(const Field& a) {
  Field power = a;
  for (int bit = 250; bit >= 0; --bit) {  // all bits are ones, but bit 1
    power = square(power);
    if (bit != 1) power = multiply(power, a);
  }
  return power;
}

/// Returns 1 / a, which is a^(p - 2) = (a^(2^252 - 3))^8 * a^3.
Field invert(const Field& a) {
  return multiply(square(square(square(power252m3(a)))), multiply(square(a), a));
}

using Bytes32 = std::array<std::uint8_t, 32>;

/// Returns the number in the low 255 bits.
Field decode(std::span<const std::uint8_t, 32> bytes) {
  Field a{};
  for (std::size_t bit = 0; bit < 255; ++bit) {
    const std::uint64_t value = bytes[bit / 8] >> (bit % 8) & 1U;
    a[bit / kLimbBits] |= value << (bit % kLimbBits);
  }
  return a;
}

/// Returns the bytes of the smallest number that equals a modulo p.
Bytes32 encode(Field a) {
  // Bits from 255 on are worth 19 each. Then a + 19 overflows 2^255 exactly if a is p or more.
  for (int round = 0; round < 2; ++round) {
    a[0] += 19 * (a[8] >> 23U);
    a[8] &= (std::uint64_t{1} << 23U) - 1;
    for (std::size_t i = 0; i < 8; ++i) {
      a[i + 1] += a[i] >> kLimbBits;
      a[i] &= kLimb;
    }
  }
  Field probe = a;
  probe[0] += 19;
  for (std::size_t i = 0; i < 8; ++i) {
    probe[i + 1] += probe[i] >> kLimbBits;
    probe[i] &= kLimb;
  }
  if (probe[8] >> 23U != 0) {
    probe[8] &= (std::uint64_t{1} << 23U) - 1;
    a = probe;
  }
  Bytes32 bytes{};
  for (std::size_t bit = 0; bit < 255; ++bit) {
    const std::uint64_t value = a[bit / kLimbBits] >> (bit % kLimbBits) & 1U;
    bytes[bit / 8] |= static_cast<std::uint8_t>(value << (bit % 8));
  }
  return bytes;
}

bool isEqual(const Field& a, const Field& b) { return encode(a) == encode(b); }
bool isOdd(const Field& a) { return (encode(a)[0] & 1U) != 0; }

Field makeField(std::uint64_t value) { return {value}; }

/// The curve's constants: d = -121665/121666, 2 d, and sqrt(-1) = 2^((p - 1)/4).
struct Curve {
  Field d = multiply(subtract(kZero, makeField(121'665)), invert(makeField(121'666)));
  Field d2 = add(d, d);
  // (p - 1)/4 = 2^253 - 5 = 2 * (2^252 - 3) + 1.
  Field root = multiply(square(power252m3(makeField(2))), makeField(2));
};

const Curve& curve() {
  static const Curve the_curve;
  return the_curve;
}

/// Adds two points (RFC 8032, section 5.1.4). The formula holds for all points.
Point add(const Point& p, const Point& q) {
  const Field a = multiply(subtract(p.y, p.x), subtract(q.y, q.x));
  const Field b = multiply(add(p.y, p.x), add(q.y, q.x));
  const Field c = multiply(multiply(p.t, curve().d2), q.t);
  const Field zz = multiply(p.z, q.z);
  const Field d = add(zz, zz);
  const Field e = subtract(b, a), f = subtract(d, c), g = add(d, c), h = add(b, a);
  return {multiply(e, f), multiply(g, h), multiply(f, g), multiply(e, h)};
}

/// Doubles a point (RFC 8032, section 5.1.4).
Point doublePoint(const Point& p) {
  const Field a = square(p.x), b = square(p.y), zz = square(p.z);
  const Field h = add(a, b);
  const Field e = subtract(h, square(add(p.x, p.y)));
  const Field g = subtract(a, b);
  const Field f = add(add(zz, zz), g);
  return {multiply(e, f), multiply(g, h), multiply(f, g), multiply(e, h)};
}

Point negate(const Point& p) { return {subtract(kZero, p.x), p.y, p.z, subtract(kZero, p.t)}; }

const Point& base() {  // y = 4/5, with an even x
  static const Point the_base = [] {
    return *decodePoint(encode(multiply(makeField(4), invert(makeField(5)))));
  }();
  return the_base;
}

// Scalars have 256 bits, least significant word first.
using Scalar = std::array<std::uint32_t, 8>;
/// Order of the base point: 2^252 + 27742317777372353535851937790883648493.
constexpr Scalar kOrder{0x5CF5D3ED, 0x5812631A, 0xA2F79CD6, 0x14DEF9DE, 0, 0, 0, 0x10000000};

bool isBelowOrder(const Scalar& a) {
  return std::lexicographical_compare(a.rbegin(), a.rend(), kOrder.rbegin(), kOrder.rend());
}

Scalar toScalar(std::span<const std::uint8_t, 32> bytes) {
  Scalar a{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    a[i / 4] |= std::uint32_t{bytes[i]} << (8 * (i % 4));
  return a;
}

/// Returns the number in the bytes, least significant first, modulo the order.
Scalar reduce(std::span<const std::uint8_t, 64> bytes) {
  Scalar rest{};
  for (std::size_t bit = 512; bit-- > 0;) {  // rest = 2 rest + bit
    std::uint32_t over = bytes[bit / 8] >> (bit % 8) & 1U;
    for (std::uint32_t& word : rest) {
      const std::uint32_t top = word >> 31U;
      word = word << 1U | over;
      over = top;
    }
    if (isBelowOrder(rest)) continue;
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const std::uint64_t difference = std::uint64_t{rest[i]} - kOrder[i] - borrow;
      rest[i] = static_cast<std::uint32_t>(difference);
      borrow = difference >> 63U;
    }
  }
  return rest;
}

bool hasBit(const Scalar& a, std::size_t bit) { return (a[bit / 32] >> (bit % 32) & 1U) != 0; }

/// Returns a * p + b * q by the trick of Straus and Shamir: both share the doublings.
Point computeSum(const Scalar& a, const Point& p, const Scalar& b, const Point& q) {
  const Point both = add(p, q);
  Point sum{kZero, kOne, kOne, kZero};
  for (std::size_t bit = 253; bit-- > 0;) {
    sum = doublePoint(sum);
    const bool with_p = hasBit(a, bit), with_q = hasBit(b, bit);
    if (with_p || with_q) sum = add(sum, with_p && with_q ? both : with_p ? p : q);
  }
  return sum;
}

}  // namespace

std::optional<Point> decodePoint(std::span<const std::uint8_t, 32> bytes) {
  const Field y = decode(bytes);
  const Field yy = square(y);
  const Field u = subtract(yy, kOne), v = add(multiply(curve().d, yy), kOne);
  const Field v3 = multiply(square(v), v);
  const Field v7 = multiply(square(v3), v);
  Field x = multiply(multiply(u, v3), power252m3(multiply(u, v7)));  // sqrt(u / v), if it exists
  const Field check = multiply(v, square(x));
  if (!isEqual(check, u)) {
    if (!isEqual(check, subtract(kZero, u))) return std::nullopt;
    x = multiply(x, curve().root);
  }
  if (isOdd(x) != (bytes[31] >> 7U != 0)) x = subtract(kZero, x);
  return Point{x, y, kOne, multiply(x, y)};
}

bool verify(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t, 64> signature,
            std::span<const std::uint8_t, 32> key, const Point& point) {
  const auto r = signature.first<32>();
  const Scalar s = toScalar(signature.last<32>());
  if (!isBelowOrder(s)) return false;
  const std::array<std::span<const std::uint8_t>, 3> parts{r, key, bytes};
  const Scalar h = reduce(computeSha512(parts));
  const Point sum = computeSum(s, base(), h, negate(point));
  const Field z = invert(sum.z);
  Bytes32 expected = encode(multiply(sum.y, z));
  if (isOdd(multiply(sum.x, z))) expected[31] |= 0x80;
  return std::equal(r.begin(), r.end(), expected.begin());
}

}  // namespace hapticast::client::ed25519
