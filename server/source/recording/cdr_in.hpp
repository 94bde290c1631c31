// SPDX-License-Identifier: MIT
// Reads CDR (OMG Common Data Representation, version 1), the form of messages of ROS 2. Four bytes
// stand in front; the second one has the byte order: 0 big-endian, 1 little-endian. Each number
// stands at a multiple of its size, counted from behind these four bytes. A text is its length with
// the zero at its end (uint32), the bytes and the zero. A sequence is its length (uint32) and the
// elements. The bytes are not trusted. Thread: any.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace hapticast::server {

/// Reads values in their order. After the first one that is missing, problem() is set, and all
/// results are 0 or empty.
class CdrIn {
 public:
  /// Requires `message` to outlive this object and all texts and bytes that it returns.
  explicit CdrIn(std::span<const std::uint8_t> message);

  /// Returns why a value could not be read, as a phrase ("has a message that is cut off"); empty:
  /// all were read.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  // Return the next value.
  std::uint8_t uint8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint32_t uint32() { return static_cast<std::uint32_t>(number(4)); }
  std::int32_t int32() { return static_cast<std::int32_t>(number(4)); }
  double float64() { return std::bit_cast<double>(number(8)); }
  std::string_view text();
  /// Returns the next sequence of bytes.
  std::span<const std::uint8_t> bytes() { return take(uint32()); }
  /// Skips the next sequence of float64.
  void skipFloats();

 private:
  [[nodiscard]] std::uint64_t number(std::size_t size);
  [[nodiscard]] std::span<const std::uint8_t> take(std::size_t count);
  void fail();

  std::span<const std::uint8_t> content_;  // behind the four bytes
  std::size_t at_ = 0;
  bool big_endian_ = false;
  std::string problem_;
};

}  // namespace hapticast::server
