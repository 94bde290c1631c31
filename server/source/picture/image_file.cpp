// SPDX-License-Identifier: MIT
#include "server/source/picture/image_file.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/picture/depth_file.hpp"

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

constexpr std::uintmax_t kMaxFile_bytes = 64U << 20U;
constexpr float kFarthest_mm = 1e7F;  // 10 km: a float beyond it is no measured depth

using Bytes = std::span<const std::uint8_t>;

std::optional<PictureSize> pngSize(Bytes bytes) {
  constexpr std::array<std::uint8_t, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  if (bytes.size() < 24 || !std::equal(kSignature.begin(), kSignature.end(), bytes.begin())) {
    return std::nullopt;
  }
  const auto bigEndian = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (const std::uint8_t byte : bytes.subspan(at, 4)) value = value << 8U | byte;
    return value;
  };
  return PictureSize{bigEndian(16), bigEndian(20)};
}

/// Reads the whole file. Returns the problem, or "".
std::string readBytes(const std::filesystem::path& file, std::vector<std::uint8_t>& bytes) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return "cannot be read (" + error.message() + ")";
  if (size == 0) return "is empty";
  if (size > kMaxFile_bytes) return "is larger than 64 MiB";
  bytes.resize(size);
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  return in ? "" : "cannot be read";
}

ImageResult readFile(const std::filesystem::path& file, int flags) {
  std::vector<std::uint8_t> bytes;
  if (std::string problem = readBytes(file, bytes); !problem.empty()) return {{}, problem};
  return decodeImage(bytes, flags);
}

}  // namespace

ImageResult decodeImage(std::span<const std::uint8_t> bytes, int flags) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (isNpy(bytes)) return decodeNpy(bytes);
  auto size = pngSize(bytes);
  if (!size) size = jpegSize(bytes);
  const bool has_end_mark = size.has_value();
  if (!size) size = depthFileSize(bytes);
  if (!size) return {{}, "is not a whole PNG, JPEG, TIFF, EXR, PGM or NPY image"};
  if (!sizeReadable(size->width_px, size->height_px))
    return {{}, describeTooLarge(size->width_px, size->height_px)};
  // Decoders would fill a missing part with grey.
  const std::string_view last = bytes[0] == 0x89 ? "IEND" : "\xFF\xD9";
  if (has_end_mark && text.rfind(last) == std::string_view::npos) return {{}, "is cut off"};
  // Decoders describe damaged files on stderr. The caller reports each with its name.
  [[maybe_unused]] static const auto kBefore =
      cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::Mat image;
  try {
    image = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1,
                                 const_cast<std::uint8_t*>(bytes.data())),
                         flags);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty() || image.cols != static_cast<int>(size->width_px) ||
      image.rows != static_cast<int>(size->height_px))
    return {{}, "cannot be decoded"};
  return {image, ""};
}

void setDepthUnit(DepthFormat& format, const std::optional<double>& mm_per_unit,
                  const std::string& file) {
  if (!mm_per_unit) return;
  if (format.kind != DepthKind::kMetric)
    throw SourceError(file + ": has depth of 8 bits, which are heights; leave --depth-unit out");
  format.mm_per_unit = *mm_per_unit;
}

std::string sizeText(int width_px, int height_px) {
  return std::to_string(width_px) + "x" + std::to_string(height_px);
}

bool sizeReadable(std::int64_t width_px, std::int64_t height_px) {
  return width_px >= 1 && height_px >= 1 && width_px <= kMostSide_px && height_px <= kMostSide_px &&
         width_px * height_px <= kMostPixels;
}

std::string describeTooLarge(std::int64_t width_px, std::int64_t height_px) {
  return "is " + std::to_string(width_px) + "x" + std::to_string(height_px) + ", larger than " +
         std::to_string(kMostSide_px) + " px a side or " + sizeText(kMostSide_px, 4320) + " in all";
}

bool sizeAllowed(int width_px, int height_px) {
  return width_px >= 1 && height_px >= 1 && width_px <= kMaxWidth_px && height_px <= kMaxHeight_px;
}

ImageResult readColorFile(const std::filesystem::path& file) {
  // Ignores the orientation tag of phones, because depth images have none.
  return readFile(file, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

ImageResult readRawFile(const std::filesystem::path& file) {
  return readFile(file, cv::IMREAD_UNCHANGED);
}

ImageResult toDepth(const cv::Mat& raw, const DepthFormat& format) {
  const bool metric = format.kind == DepthKind::kMetric;
  cv::Mat depth;
  if (metric && (raw.type() == CV_16UC1 || raw.type() == CV_32FC1)) {
    raw.convertTo(depth, CV_32F, format.mm_per_unit);
    // Estimators mark a missing depth by NaN, infinity or a negative value; here it is 0.
    const cv::Mat usable = (depth > 0.0F) & (depth < kFarthest_mm);
    depth.setTo(0.0F, ~usable);
  } else if (!metric && raw.type() == CV_8UC1) {
    raw.convertTo(depth, CV_32F);
  } else if (!metric && raw.type() == CV_8UC3) {
    cv::Mat grey;
    cv::cvtColor(raw, grey, cv::COLOR_BGR2GRAY);
    grey.convertTo(depth, CV_32F);
  } else {
    return {{},
            "has " + std::to_string(raw.channels()) + " channel(s) of " +
                std::to_string(8 * raw.elemSize1()) + " bits where " +
                (metric ? "one of 16, or of 32 (float)," : "one of 8") + " is expected"};
  }
  return {depth, ""};
}

ImageResult toMask(const cv::Mat& raw) {
  if (raw.type() != CV_8UC1) return {{}, "is not an 8-bit grey image"};
  double largest = 0.0;
  cv::minMaxLoc(raw, nullptr, &largest);
  if (largest <= static_cast<double>(kMaxObjects)) return {raw, ""};
  cv::Mat mask;
  cv::threshold(raw, mask, 127.0, 1.0, cv::THRESH_BINARY);
  return {mask, ""};
}

bool isColorCoded(const cv::Mat& raw) {
  if (raw.type() != CV_8UC3) return false;
  std::array<cv::Mat, 3> bgr;
  cv::split(raw, bgr.data());
  cv::Mat most;
  cv::Mat least;
  cv::max(cv::max(bgr[0], bgr[1]), bgr[2], most);
  cv::min(cv::min(bgr[0], bgr[1]), bgr[2], least);
  // Grey after a lossy codec stays within a few levels; colours differ by tens of levels. A share,
  // because the background of a picture may be black.
  constexpr double kGreyTolerance = 24.0;
  constexpr double kFewColored = 0.02;
  const int colored = cv::countNonZero(most - least > kGreyTolerance);
  return colored > kFewColored * static_cast<double>(raw.total());
}

}  // namespace hapticast::server
