// SPDX-License-Identifier: MIT
// Encoding of protobuf: tags, varints, fixed numbers, bytes and groups, as libprotobuf reads and
// writes them. The reader never leaves its bytes and needs no memory. Thread: any, one at a time
// for each object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace hapticast {

/// Wire type of a field, the low three bits of its tag.
enum class WireType : std::uint8_t {
  kVarint = 0,
  kFixed64 = 1,
  kBytes = 2,
  kBeginGroup = 3,
  kEndGroup = 4,
  kFixed32 = 5,
};

/// Return the parts of a tag.
[[nodiscard]] constexpr WireType typeOf(std::uint32_t tag) {
  return static_cast<WireType>(tag & 7U);
}
[[nodiscard]] constexpr std::uint32_t numberOf(std::uint32_t tag) { return tag >> 3U; }

/// Returns whether `text` is valid UTF-8.
[[nodiscard]] bool isUtf8(std::string_view text);

/// Reads the fields of one message. After a function has returned false, the rest is undefined.
class WireReader {
 public:
  /// Largest depth of messages and groups in each other, as in libprotobuf.
  static constexpr int kMostDepth = 100;

  explicit WireReader(std::span<const std::uint8_t> bytes, int depth = kMostDepth)
      : rest_(bytes), depth_(depth) {}

  [[nodiscard]] bool atEnd() const { return rest_.empty(); }

  /// Reads the tag of a field. Returns false if it is no tag, or the number is 0.
  bool readTag(std::uint32_t& tag);
  bool readVarint(std::uint64_t& value);
  template <class T>
  bool readFixed(T& value) {
    std::span<const std::uint8_t> bytes;
    if (!read(sizeof(T), bytes)) return false;
    std::memcpy(&value, bytes.data(), sizeof(T));  // both are little-endian
    return true;
  }
  /// Reads a length, and lets `bytes` refer to that many bytes of the input; false: too few.
  bool readBytes(std::span<const std::uint8_t>& bytes);
  /// Reads a length, and calls `visit` with a reader of so many bytes. Returns its result.
  template <class Visit>
  bool readMessage(Visit visit) {
    std::span<const std::uint8_t> bytes;
    if (!readBytes(bytes) || depth_ == 0) return false;
    WireReader inner(bytes, depth_ - 1);
    return visit(inner);
  }
  /// Skips the content of the field whose `tag` readTag() has just returned. Returns false if it is
  /// cut off, nested too deep, or has no valid wire type.
  bool skip(std::uint32_t tag);

 private:
  bool read(std::size_t size, std::span<const std::uint8_t>& bytes);
  bool skipGroup(std::uint32_t number);

  std::span<const std::uint8_t> rest_;
  int depth_;
};

/// Writes the fields of one message.
class WireWriter {
 public:
  void tag(std::uint32_t number, WireType type) {
    varint(std::uint64_t{number} << 3U | static_cast<std::uint64_t>(type));
  }
  void varint(std::uint64_t value);
  template <class T>
  void fixed(const T& value) {
    const std::size_t before = bytes_.size();
    bytes_.resize(before + sizeof(T));
    std::memcpy(bytes_.data() + before, &value, sizeof(T));
  }
  /// Writes a length and `bytes`.
  void bytes(std::string_view bytes) {
    varint(bytes.size());
    bytes_ += bytes;
  }
  [[nodiscard]] const std::string& result() const& { return bytes_; }
  [[nodiscard]] std::string result() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace hapticast
