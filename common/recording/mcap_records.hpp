// SPDX-License-Identifier: MIT
// Records of the file format MCAP (version 0, mcap.dev/spec). A file is: magic, records, magic. A
// record is a code (1 byte), the length of its content (8 bytes) and the content. All numbers are
// little-endian. A text has its length (4 bytes) in front. Messages stand in chunks. Each chunk has
// a CRC-32, and the times and places of its messages follow it. At the end of the file a summary
// repeats the schemas and channels, and has the place of each chunk. Thread: any.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hapticast {

inline constexpr std::array<std::uint8_t, 8> kMcapMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

/// Codes of the records.
enum class McapCode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kDataEnd = 15,
};

/// Bytes of a record before its content.
inline constexpr std::size_t kMcapRecordHeadBytes = 9;
/// Bytes of the footer's record.
inline constexpr std::size_t kMcapFooterBytes = kMcapRecordHeadBytes + 20;

/// Description of the data of a channel. `data` depends on `encoding`; for "protobuf" it is a
/// FileDescriptorSet.
struct McapSchema {
  std::string name;
  std::string encoding;
  std::string data;
};

/// Messages of one kind.
struct McapChannel {
  std::string topic;
  std::string message_encoding;  ///< "protobuf", "json", "cdr" and others
  McapSchema schema;             ///< empty: the channel has none
  /// A message holds until the next one, so a watcher that comes later needs it. Not in the file.
  bool is_state = false;
};

/// Appends numbers, texts and records to bytes.
class McapOut {
 public:
  /// Requires `bytes` to outlive this object.
  explicit McapOut(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  /// Append a number, a text with its length, or bytes. They return this object.
  template <class Number>
  McapOut& number(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    return *this;
  }
  McapOut& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  McapOut& data(std::span<const std::uint8_t> value) {
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  /// Begins a record. Returns its place for endRecord().
  std::size_t beginRecord(McapCode code);
  /// Ends the record that began at `place`: writes the length of its content.
  void endRecord(std::size_t place);
  /// Write the record of a schema, or of a channel.
  void writeSchema(std::uint16_t id, const McapSchema& schema);
  void writeChannel(std::uint16_t id, std::uint16_t schema_id, const McapChannel& channel);

 private:
  std::vector<std::uint8_t>& bytes_;
};

/// Reads numbers and texts from bytes from outside. After the first one that is missing, ok() is
/// false and all results are 0 or empty.
class McapIn {
 public:
  explicit McapIn(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::span<const std::uint8_t> rest() const { return rest_; }
  /// Return the next number, or the next text, which is valid as long as the bytes.
  template <class Number>
  Number number() {
    const auto bytes = take(sizeof(Number));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
    return static_cast<Number>(value);
  }
  std::string_view text() { return toText(take(number<std::uint32_t>())); }
  /// Returns the next `count` bytes.
  std::span<const std::uint8_t> take(std::uint64_t count);

 private:
  static std::string_view toText(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::span<const std::uint8_t> rest_;
  bool ok_ = true;
};

/// A record: its code and its content.
struct McapRecord {
  McapCode code{};
  std::span<const std::uint8_t> content;
};

/// Reads the next record from `in`. Returns nullopt if `in` has no whole record. A code of 0 is
/// none: a chunk of zeros would be 28 million records.
[[nodiscard]] std::optional<McapRecord> readRecord(McapIn& in);

}  // namespace hapticast
