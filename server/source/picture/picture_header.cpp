// SPDX-License-Identifier: MIT
#include "server/source/picture/picture_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <string_view>

#include "server/source/picture/byte_stream.hpp"

namespace hapticast::server {

std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg) {
  const auto word = [&](std::size_t at) -> std::uint32_t {
    return (std::uint32_t{jpeg[at]} << 8U) | jpeg[at + 1];
  };
  if (jpeg.size() < 4 || word(0) != 0xFFD8) return std::nullopt;
  // Segments: FF, marker, big-endian length (which counts itself), content.
  std::size_t at = 2;
  while (at + 4 <= jpeg.size() && jpeg[at] == 0xFF) {
    const std::uint8_t marker = jpeg[at + 1];
    if (marker == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    const std::uint32_t length = word(at + 2);
    if (length < 2) return std::nullopt;
    // SOF0..SOF15 without DHT, JPG and DAC.
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
      if (length < 8 || at + 9 > jpeg.size()) return std::nullopt;
      return PictureSize{word(at + 7), word(at + 5)};
    }
    at += 2 + std::size_t{length};
  }
  return std::nullopt;
}

namespace {

using Bytes = std::span<const std::uint8_t>;
using Header = std::optional<PictureHeader>;

constexpr std::string_view kCutOff = "is cut off";

std::string cutIf(bool cut) { return cut ? std::string(kCutOff) : ""; }

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

/// PNG: the first chunk (IHDR) begins with the size, the last one is IEND.
Header pngHeader(Bytes bytes) {
  const std::string_view text = toText(bytes);
  if (bytes.size() < 24 || !text.starts_with("\x89PNG\r\n\x1A\n")) return std::nullopt;
  IntegerReader in{bytes, true};
  // The decoder would fill a missing part with grey.
  return PictureHeader{{in.read(16, 4), in.read(20, 4)},
                       cutIf(text.rfind("IEND") == std::string_view::npos)};
}

Header jpegHeader(Bytes bytes) {
  const auto size = jpegSize(bytes);
  if (!size) return std::nullopt;
  return PictureHeader{*size, cutIf(toText(bytes).rfind("\xFF\xD9") == std::string_view::npos)};
}

/// WebP (RFC 9649): a RIFF file whose first chunk is "VP8 ", "VP8L" or "VP8X".
Header webpHeader(Bytes bytes) {
  constexpr std::uint32_t kAnimation = 2;
  const std::string_view text = toText(bytes);
  if (!text.starts_with("RIFF") || text.size() < 30 || text.substr(8, 4) != "WEBP")
    return std::nullopt;
  IntegerReader in{bytes};
  PictureHeader header{{}, cutIf(bytes.size() - 8 < in.read(4, 4))};
  const std::string_view chunk = text.substr(12, 4);
  if (chunk == "VP8 ") {
    header.size = {in.read(26, 2) & 0x3FFFU, in.read(28, 2) & 0x3FFFU};
  } else if (chunk == "VP8L") {
    const std::uint32_t sides = in.read(21, 4);
    header.size = {(sides & 0x3FFFU) + 1, (sides >> 14U & 0x3FFFU) + 1};
  } else if (chunk == "VP8X") {
    header.size = {in.read(24, 3) + 1, in.read(27, 3) + 1};
    if ((in.read(20, 1) & kAnimation) != 0)
      header.problem = "is an animated WebP; save each picture as a file";
  } else {
    return std::nullopt;
  }
  return header;
}

/// BMP: 14 bytes with the place of the pixels, then a header that begins with its own length.
Header bmpHeader(Bytes bytes) {
  constexpr std::uint32_t kOs2_bytes = 12;
  if (!toText(bytes).starts_with("BM")) return std::nullopt;
  IntegerReader in{bytes};
  const std::uint64_t pixels = in.read(10, 4);
  const std::uint32_t length = in.read(14, 4);
  const bool os2 = length == kOs2_bytes;
  if (!os2 && length < 36) return std::nullopt;
  const std::int64_t width_px = os2 ? in.read(18, 2) : static_cast<std::int32_t>(in.read(18, 4));
  // A negative height means that the rows begin at the top.
  const std::int64_t height_px =
      os2 ? in.read(20, 2) : std::abs(std::int64_t{static_cast<std::int32_t>(in.read(22, 4))});
  const std::uint64_t bits = in.read(os2 ? 24 : 28, 2);
  const std::uint32_t compression = os2 ? 0 : in.read(30, 4);
  if (!in.good || width_px < 1 || height_px < 1) return std::nullopt;
  const auto rows = static_cast<std::uint64_t>(height_px);
  const std::uint64_t row_bytes = (static_cast<std::uint64_t>(width_px) * bits + 31) / 32 * 4;
  const bool run_lengths = compression == 1 || compression == 2;
  const std::uint64_t content = run_lengths ? in.read(34, 4) : row_bytes * rows;
  return PictureHeader{
      {static_cast<std::uint32_t>(width_px), static_cast<std::uint32_t>(height_px)},
      cutIf(bytes.size() < pixels + content)};
}

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

/// Removes white space and comments, then a number of at most 9 digits. Returns nullopt if there is
/// none.
std::optional<std::uint32_t> takeNumber(std::string_view& text) {
  constexpr std::size_t kMostDigits = 9;
  const auto is = [&](int (*kind)(int)) {
    return !text.empty() && kind(static_cast<unsigned char>(text[0])) != 0;
  };
  while (is(std::isspace) || text.starts_with('#'))
    text.remove_prefix(text[0] == '#' ? std::min(text.find_first_of("\r\n"), text.size()) : 1);
  std::uint32_t number = 0;
  std::size_t digits = 0;
  for (; is(std::isdigit) && digits <= kMostDigits; ++digits) {
    number = number * 10 + static_cast<std::uint32_t>(text[0] - '0');
    text.remove_prefix(1);
  }
  return digits >= 1 && digits <= kMostDigits ? std::optional(number) : std::nullopt;
}

/// PGM and PPM (netpbm): "P5" or "P6", width, height, largest value, one white space; `#` begins a
/// comment.
Header netpbmHeader(Bytes bytes) {
  std::string_view text = toText(bytes);
  const bool color = text.starts_with("P6");
  if (!color && !text.starts_with("P5")) return std::nullopt;
  text.remove_prefix(2);
  const auto width_px = takeNumber(text);
  const auto height_px = width_px ? takeNumber(text) : std::nullopt;
  const auto largest = height_px ? takeNumber(text) : std::nullopt;
  if (!largest) return std::nullopt;
  // The decoder would leave a missing part undefined. Sides of 0 are refused later.
  const std::uint64_t pixel_bytes = std::uint64_t{color ? 3U : 1U} * (*largest > 255 ? 2U : 1U);
  const std::uint64_t content_pixels = text.empty() ? 0 : (text.size() - 1) / pixel_bytes;
  return PictureHeader{{*width_px, *height_px},
                       cutIf(content_pixels < std::uint64_t{*width_px} * *height_px)};
}

/// Converts the size of a format whose end cannot be checked.
Header withoutEnd(std::optional<PictureSize> size) {
  return size ? Header({*size, ""}) : std::nullopt;
}

}  // namespace

std::optional<PictureHeader> readPictureHeader(Bytes bytes) {
  if (auto header = pngHeader(bytes)) return header;
  if (auto header = jpegHeader(bytes)) return header;
  if (auto header = webpHeader(bytes)) return header;
  if (auto header = bmpHeader(bytes)) return header;
  if (auto header = withoutEnd(tiffSize(bytes))) return header;
  if (auto header = withoutEnd(exrSize(bytes))) return header;
  return netpbmHeader(bytes);
}

}  // namespace hapticast::server
