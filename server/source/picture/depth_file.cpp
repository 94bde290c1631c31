// SPDX-License-Identifier: MIT
#include "server/source/picture/depth_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <string>
#include <string_view>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kNpyMagic = "\x93NUMPY";

std::string_view toText(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads integers of a file in its own byte order. After a read beyond the end `good` is false.
struct IntegerReader {
  Bytes bytes;
  bool big_endian = false;
  bool good = true;

  std::uint32_t read(std::size_t at, std::size_t count) {
    if (at > bytes.size() || bytes.size() - at < count) {
      good = false;
      return 0;
    }
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
      value = value << 8U | bytes[at + (big_endian ? i : count - 1 - i)];
    return value;
  }
};

/// TIFF 6.0: the first directory has the tags 256 (width) and 257 (height), each SHORT or LONG.
std::optional<PictureSize> tiffSize(Bytes bytes) {
  const std::string_view text = toText(bytes);
  const bool little = text.starts_with(std::string_view("II*\0", 4));
  if (!little && !text.starts_with(std::string_view("MM\0*", 4))) return std::nullopt;
  IntegerReader in{bytes, !little};
  const std::size_t directory = in.read(4, 4);
  const std::uint32_t entries = in.read(directory, 2);
  PictureSize size;
  for (std::uint32_t i = 0; i < entries && in.good; ++i) {
    const std::size_t entry = directory + 2 + std::size_t{12} * i;
    const std::uint32_t tag = in.read(entry, 2);
    const std::uint32_t value = in.read(entry + 8, in.read(entry + 2, 2) == 3 ? 2 : 4);
    if (tag == 256) size.width_px = value;
    if (tag == 257) size.height_px = value;
  }
  return in.good && size.width_px > 0 && size.height_px > 0 ? std::optional(size) : std::nullopt;
}

/// OpenEXR: attributes of a name, a type, a length and a value; `dataWindow` has four corners.
std::optional<PictureSize> exrSize(Bytes bytes) {
  constexpr int kMostAttributes = 100;
  const std::string_view text = toText(bytes);
  if (!text.starts_with("\x76\x2F\x31\x01")) return std::nullopt;
  IntegerReader in{bytes};
  std::size_t at = 8;
  for (int i = 0; i < kMostAttributes && in.good; ++i) {
    const std::size_t name_end = text.find('\0', at);
    if (name_end == std::string_view::npos || name_end == at) return std::nullopt;
    const std::size_t type_end = text.find('\0', name_end + 1);
    if (type_end == std::string_view::npos) return std::nullopt;
    const std::size_t value = type_end + 5;
    if (text.substr(at, name_end - at) == "dataWindow") {
      std::array<std::int64_t, 4> corner{};
      for (std::size_t k = 0; k < corner.size(); ++k)
        corner[k] = static_cast<std::int32_t>(in.read(value + 4 * k, 4));
      const std::int64_t width_px = corner[2] - corner[0] + 1;
      const std::int64_t height_px = corner[3] - corner[1] + 1;
      if (!in.good || width_px < 1 || height_px < 1) return std::nullopt;
      return PictureSize{static_cast<std::uint32_t>(std::min<std::int64_t>(width_px, 1 << 30)),
                         static_cast<std::uint32_t>(std::min<std::int64_t>(height_px, 1 << 30))};
    }
    at = value + in.read(type_end + 1, 4);
  }
  return std::nullopt;
}

/// PGM (netpbm): "P5", width, height, largest value, one white space; `#` begins a comment.
std::optional<PictureSize> pgmSize(Bytes bytes) {
  std::string_view text = toText(bytes);
  if (!text.starts_with("P5")) return std::nullopt;
  text.remove_prefix(2);
  std::array<std::uint32_t, 3> numbers{};
  for (std::uint32_t& number : numbers) {
    while (!text.empty() &&
           (std::isspace(static_cast<unsigned char>(text[0])) != 0 || text[0] == '#'))
      text.remove_prefix(text[0] == '#' ? std::min(text.find('\n'), text.size()) : 1);
    std::size_t digits = 0;
    while (digits < text.size() && digits < 6 &&
           std::isdigit(static_cast<unsigned char>(text[digits])) != 0)
      number = number * 10 + static_cast<std::uint32_t>(text[digits++] - '0');
    if (digits == 0) return std::nullopt;
    text.remove_prefix(digits);
  }
  // The decoder would leave a missing part undefined.
  const std::uint64_t content =
      std::uint64_t{numbers[0]} * numbers[1] * (numbers[2] > 255 ? 2U : 1U) + 1;
  if (text.size() < content) return std::nullopt;
  return PictureSize{numbers[0], numbers[1]};
}

/// The header of an NPY file, a Python dictionary.
struct NpyHeader {
  std::string type;
  PictureSize size;
  std::size_t content = 0;  ///< where the matrix begins
};

/// Returns the text between `begin` and `end` behind `key`.
std::string_view findValue(std::string_view text, std::string_view key, char begin, char end) {
  const std::size_t at = text.find(key);
  const std::size_t from = at == std::string_view::npos ? at : text.find(begin, at + key.size());
  const std::size_t to = from == std::string_view::npos ? from : text.find(end, from + 1);
  return to == std::string_view::npos ? std::string_view() : text.substr(from + 1, to - from - 1);
}

std::optional<NpyHeader> readNpyHeader(Bytes bytes) {
  IntegerReader in{bytes};
  const std::uint32_t version = in.read(6, 1);
  const std::size_t begin = version >= 2 ? 12 : 10;
  const std::size_t length = in.read(8, begin - 8);
  if (!in.good || version < 1 || version > 3 || length > bytes.size() - begin) return std::nullopt;
  const std::string_view text = toText(bytes).substr(begin, length);
  if (text.find("'fortran_order': False") == std::string_view::npos) return std::nullopt;
  NpyHeader header{.type = std::string(findValue(text, "'descr':", '\'', '\'')),
                   .size = {},
                   .content = begin + length};
  const std::string_view shape = findValue(text, "'shape':", '(', ')');
  const std::size_t comma = shape.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto height = parseNumber(trim(shape.substr(0, comma)));
  const auto width = parseNumber(trim(shape.substr(comma + 1)));
  if (!width || !height || !(*width >= 1.0 && *width < 1e6) || !(*height >= 1.0 && *height < 1e6))
    return std::nullopt;
  header.size = {static_cast<std::uint32_t>(*width), static_cast<std::uint32_t>(*height)};
  return header;
}

}  // namespace

std::optional<PictureSize> depthFileSize(Bytes bytes) {
  if (auto size = tiffSize(bytes)) return size;
  if (auto size = exrSize(bytes)) return size;
  return pgmSize(bytes);
}

bool isNpy(Bytes bytes) { return toText(bytes).starts_with(kNpyMagic); }

ImageResult decodeNpy(Bytes bytes) {
  const auto header = readNpyHeader(bytes);
  if (!header) return {{}, "is not an NPY matrix of two dimensions in the order of C"};
  const auto width_px = static_cast<int>(header->size.width_px);
  const auto height_px = static_cast<int>(header->size.height_px);
  if (!sizeReadable(width_px, height_px)) return {{}, describeTooLarge(width_px, height_px)};
  const int type = header->type == "|u1"   ? CV_8UC1
                   : header->type == "<u2" ? CV_16UC1
                   : header->type == "<f4" ? CV_32FC1
                   : header->type == "<f8" ? CV_64FC1
                                           : -1;
  if (type < 0)
    return {{}, "has values of the type " + quote(header->type) + ", not |u1, <u2, <f4 or <f8"};
  cv::Mat image(height_px, width_px, type);
  const std::size_t size = image.total() * image.elemSize();
  if (bytes.size() - header->content < size) return {{}, "is cut off"};
  std::memcpy(image.data, bytes.data() + header->content, size);
  if (type == CV_64FC1) image.convertTo(image, CV_32F);
  return {image, ""};
}

}  // namespace hapticast::server
