// SPDX-License-Identifier: MIT
#include "common/protocol/scan.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

namespace hapticast {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

std::optional<std::vector<std::span<const std::uint8_t>>> submessages(
    std::span<const std::uint8_t> message, std::uint32_t field, std::size_t limit) {
  std::vector<std::span<const std::uint8_t>> found;
  CodedInputStream in(message.data(), static_cast<int>(message.size()));
  const std::uint32_t wanted =
      WireFormatLite::MakeTag(static_cast<int>(field), WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
  for (std::uint32_t tag = in.ReadTag(); tag != 0; tag = in.ReadTag()) {
    if (tag != wanted) {
      if (!WireFormatLite::SkipField(&in, tag)) break;
      continue;
    }
    int length = 0;
    if (!in.ReadVarintSizeAsInt(&length)) break;
    const auto begin = static_cast<std::size_t>(in.CurrentPosition());
    if (!in.Skip(length)) break;
    if (found.size() == limit) return std::nullopt;
    found.push_back(message.subspan(begin, static_cast<std::size_t>(length)));
  }
  return found;
}

}  // namespace hapticast
