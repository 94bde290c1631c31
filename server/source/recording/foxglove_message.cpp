// SPDX-License-Identifier: MIT
#include "server/source/recording/foxglove_message.hpp"

#include <array>
#include <bit>

#include "common/recording/mcap_records.hpp"
#include "server/source/picture/byte_stream.hpp"

namespace hapticast::server {

namespace {

/// A field. `number`: its value, if it is one. `bytes`: its content, if it has a length.
struct ProtoField {
  std::uint64_t id = 0;
  std::uint64_t number = 0;
  std::span<const std::uint8_t> bytes;
};

std::optional<std::uint64_t> readVarint(McapIn& in) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto byte = in.number<std::uint8_t>();
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if (!in.ok()) return std::nullopt;
    if (byte < 0x80) return value;
  }
  return std::nullopt;
}

/// Returns the next field; nullopt if there is no whole one.
std::optional<ProtoField> readField(McapIn& in) {
  const auto key = readVarint(in);
  if (!key) return std::nullopt;
  ProtoField field{*key >> 3U, 0, {}};
  const std::uint64_t wire_type = *key & 7U;
  if (wire_type == 1) {
    field.number = in.number<std::uint64_t>();
  } else if (wire_type == 5) {
    field.number = in.number<std::uint32_t>();
  } else if (wire_type == 0 || wire_type == 2) {
    const auto number = readVarint(in);
    if (!number) return std::nullopt;
    field.number = *number;
    if (wire_type == 2) field.bytes = in.take(*number);
  } else {
    return std::nullopt;
  }
  return in.ok() ? std::optional(field) : std::nullopt;
}

/// Calls `use` for each field. Returns whether `bytes` are whole fields.
template <class Use>
bool readFields(std::span<const std::uint8_t> bytes, Use use) {
  McapIn in(bytes);
  while (!in.rest().empty()) {
    const auto field = readField(in);
    if (!field) return false;
    use(*field);
  }
  return true;
}

/// Reads google.protobuf.Timestamp: seconds = 1, nanos = 2.
std::int64_t readTimestamp_ns(std::span<const std::uint8_t> bytes) {
  std::int64_t seconds = 0;
  std::int64_t nanoseconds = 0;
  const bool whole = readFields(bytes, [&](const ProtoField& field) {
    if (field.id == 1) seconds = static_cast<std::int64_t>(field.number);
    if (field.id == 2) nanoseconds = static_cast<std::int64_t>(field.number);
  });
  return whole ? toStamp_ns(seconds, nanoseconds) : 0;
}

void setRawField(const ProtoField& field, ImageMessage& image) {
  const auto number = static_cast<std::uint32_t>(field.number);
  if (field.id == 2) image.width_px = number;
  if (field.id == 3) image.height_px = number;
  if (field.id == 4) image.encoding = toText(field.bytes);
  if (field.id == 5) image.row_bytes = number;
  if (field.id == 6) image.data = field.bytes;
  if (field.id == 7) image.frame_id = toText(field.bytes);
}

void setCompressedField(const ProtoField& field, ImageMessage& image) {
  if (field.id == 2) image.data = field.bytes;
  if (field.id == 3) image.encoding = toText(field.bytes);
  if (field.id == 4) image.frame_id = toText(field.bytes);
}

/// The elements of a repeated double, which may be packed into one field or be fields of their own.
class MatrixIn {
 public:
  void add(const ProtoField& field) {
    if (field.bytes.empty()) {
      push(field.number);
      return;
    }
    for (McapIn in(field.bytes); in.rest().size() >= sizeof(double);)
      push(in.number<std::uint64_t>());
  }
  [[nodiscard]] bool isWhole() const { return count_ == values_.size(); }
  [[nodiscard]] const std::array<double, 9>& values() const { return values_; }

 private:
  void push(std::uint64_t bits) {
    if (count_ < values_.size()) values_[count_++] = std::bit_cast<double>(bits);
  }
  std::array<double, 9> values_{};
  std::size_t count_ = 0;
};

}  // namespace

Result<ImageMessage> readFoxgloveImage(MessageType type, std::span<const std::uint8_t> bytes) {
  ImageMessage image;
  image.is_compressed = type == MessageType::kFoxgloveCompressedImage;
  const bool whole = readFields(bytes, [&](const ProtoField& field) {
    if (field.id == 1) image.stamp_ns = readTimestamp_ns(field.bytes);
    if (image.is_compressed) {
      setCompressedField(field, image);
    } else {
      setRawField(field, image);
    }
  });
  if (!whole) return Error{"has a message that is cut off or damaged"};
  return image;
}

std::optional<CameraMessage> readFoxgloveCamera(std::span<const std::uint8_t> bytes) {
  CameraMessage camera;
  MatrixIn matrix;
  const bool whole = readFields(bytes, [&](const ProtoField& field) {
    if (field.id == 2) camera.width_px = static_cast<std::uint32_t>(field.number);
    if (field.id == 3) camera.height_px = static_cast<std::uint32_t>(field.number);
    if (field.id == 6) matrix.add(field);
  });
  if (!whole || !matrix.isWhole()) return std::nullopt;
  return withMatrix(camera, matrix.values());
}

}  // namespace hapticast::server
