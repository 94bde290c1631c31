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
#include "server/source/picture/byte_stream.hpp"
#include "server/source/picture/npy_array.hpp"
#include "server/source/picture/npz_file.hpp"
#include "server/source/picture/pfm_file.hpp"
#include "server/source/picture/picture_header.hpp"

namespace hapticast::server {

namespace {

constexpr std::uintmax_t kMaxFile_bytes = 64U << 20U;
constexpr float kFarthest_mm = 1e7F;  // 10 km: a float beyond it is no measured depth

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
  if (isNpy(bytes)) {
    MemoryStream stream(bytes);
    return readNpyMatrix(stream);
  }
  if (isZip(bytes)) {
    const StreamResult npz = openNpz(bytes);
    return npz.stream ? readNpyMatrix(*npz.stream) : ImageResult{{}, npz.problem};
  }
  if (isPfm(bytes)) return decodePfm(bytes);
  const auto header = readPictureHeader(bytes);
  if (!header) {
    return {{}, "is not a whole PNG, JPEG, WebP, BMP, PPM, PGM, TIFF, EXR, PFM, NPY or NPZ image"};
  }
  const PictureSize size = header->size;
  if (!sizeReadable(size.width_px, size.height_px))
    return {{}, describeTooLarge(size.width_px, size.height_px)};
  if (!header->problem.empty()) return {{}, header->problem};
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
  if (image.empty() || image.cols != static_cast<int>(size.width_px) ||
      image.rows != static_cast<int>(size.height_px))
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

ImageResult readColorFile(const std::filesystem::path& file) {
  // Ignores the orientation tag of phones, because depth images have none.
  ImageResult color = readFile(file, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (color.ok() && color.image.type() != CV_8UC3)
    return {{}, "is a matrix of numbers, not a colour image"};
  return color;
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
