// SPDX-License-Identifier: MIT
#include "common/recording/mcap_records.hpp"

namespace hapticast {

std::size_t McapOut::beginRecord(McapCode code) {
  const std::size_t place = bytes_.size();
  number(static_cast<std::uint8_t>(code));
  number(std::uint64_t{0});
  return place;
}

void McapOut::endRecord(std::size_t place) {
  const std::uint64_t length = bytes_.size() - place - kMcapRecordHeadBytes;
  for (std::size_t i = 0; i < sizeof(length); ++i)
    bytes_[place + 1 + i] = static_cast<std::uint8_t>(length >> (8 * i));
}

void McapOut::writeSchema(std::uint16_t id, const McapSchema& schema) {
  const std::size_t place = beginRecord(McapCode::kSchema);
  number(id).text(schema.name).text(schema.encoding).text(schema.data);
  endRecord(place);
}

void McapOut::writeChannel(std::uint16_t id, std::uint16_t schema_id, const McapChannel& channel) {
  const std::size_t place = beginRecord(McapCode::kChannel);
  number(id).number(schema_id).text(channel.topic).text(channel.message_encoding);
  number(std::uint32_t{0});  // no metadata
  endRecord(place);
}

std::span<const std::uint8_t> McapIn::take(std::uint64_t count) {
  if (!ok_ || count > rest_.size()) {
    ok_ = false;
    return {};
  }
  const auto taken = rest_.first(static_cast<std::size_t>(count));
  rest_ = rest_.subspan(static_cast<std::size_t>(count));
  return taken;
}

std::optional<McapRecord> readRecord(McapIn& in) {
  McapRecord record;
  record.code = static_cast<McapCode>(in.number<std::uint8_t>());
  record.content = in.take(in.number<std::uint64_t>());
  const bool is_whole = in.ok() && record.code != McapCode{};  // zeros are no records
  return is_whole ? std::optional(record) : std::nullopt;
}

}  // namespace hapticast
