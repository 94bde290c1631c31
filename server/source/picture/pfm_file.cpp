// SPDX-License-Identifier: MIT
#include "server/source/picture/pfm_file.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstddef>
#include <optional>
#include <string_view>

#include "common/text.hpp"
#include "server/source/picture/byte_stream.hpp"
#include "server/source/picture/picture_size.hpp"

namespace hapticast::server {

namespace {

/// Removes a word and the one white space behind it, and returns the word.
std::string_view takeWord(std::string_view& text) {
  constexpr std::size_t kMostWord_bytes = 64;
  const auto isSpace = [&](std::size_t at) {
    return std::isspace(static_cast<unsigned char>(text[at])) != 0;
  };
  std::size_t size = 0;
  while (size < text.size() && size < kMostWord_bytes && !isSpace(size)) ++size;
  const std::string_view word = text.substr(0, size);
  text.remove_prefix(std::min(size + 1, text.size()));
  return word;
}

/// Copies the rows, of which the lowest one is first in the file.
cv::Mat copyRows(std::string_view content, int width_px, int height_px, bool big_endian) {
  cv::Mat image(height_px, width_px, CV_32FC1);
  std::size_t at = 0;
  for (int v = height_px - 1; v >= 0; --v) {
    for (int u = 0; u < width_px; ++u) {
      std::uint32_t bits = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto byte = static_cast<std::uint8_t>(content[at++]);
        bits |= std::uint32_t{byte} << (8U * (big_endian ? 3 - i : i));
      }
      image.at<float>(v, u) = std::bit_cast<float>(bits);
    }
  }
  return image;
}

}  // namespace

bool isPfm(std::span<const std::uint8_t> bytes) {
  const std::string_view text = toText(bytes);
  return (text.starts_with("Pf") || text.starts_with("PF")) && text.size() > 2 &&
         std::isspace(static_cast<unsigned char>(text[2])) != 0;
}

ImageResult decodePfm(std::span<const std::uint8_t> bytes) {
  std::string_view text = toText(bytes);
  if (takeWord(text) == "PF")
    return {{}, "is a PFM image in colours, not depth; save it as grey (Pf)"};
  const auto width = parseNumberInRange<std::uint64_t>(takeWord(text), 1, 1'000'000'000);
  const auto height = parseNumberInRange<std::uint64_t>(takeWord(text), 1, 1'000'000'000);
  const auto scale = parseNumber(takeWord(text));
  if (!width || !height || !scale || *scale == 0.0) return {{}, "is not a whole PFM image"};
  const auto width_px = static_cast<int>(*width);
  const auto height_px = static_cast<int>(*height);
  if (!sizeReadable(width_px, height_px)) return {{}, describeTooLarge(width_px, height_px)};
  if (text.size() / 4 < *width * *height) return {{}, "is cut off"};
  return {copyRows(text, width_px, height_px, *scale > 0.0), ""};
}

}  // namespace hapticast::server
