// SPDX-License-Identifier: MIT
#include "server/source/live/v4l2_picture.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/haptic_frame.hpp"

namespace hapticast::server {

namespace {

static_assert(std::endian::native == std::endian::little, "Z16 and Y16 are little-endian");

/// Rows of a picture, or why there are none.
struct Rows {
  std::uint64_t stride = 0;  // bytes from row to row
  std::string problem;
};

/// Checks that `rows` rows of `used_bytes` are in `bytes`.
Rows findRows(const V4l2Format& format, std::uint64_t used_bytes, std::uint64_t rows,
              std::span<const std::uint8_t> bytes) {
  const std::uint64_t stride = format.row_bytes == 0 ? used_bytes : format.row_bytes;
  if (stride < used_bytes)
    return {0, "delivers rows of " + std::to_string(stride) + " bytes instead of " +
                   std::to_string(used_bytes)};
  const std::uint64_t needed = stride * (rows - 1) + used_bytes;
  if (bytes.size() < needed)
    return {0, "delivers " + std::to_string(bytes.size()) + " bytes instead of " +
                   std::to_string(needed)};
  return {stride, ""};
}

std::string findSizeProblem(const V4l2Format& format, std::uint32_t even_width,
                            std::uint32_t even_height) {
  const std::uint32_t width = format.width_px;
  const std::uint32_t height = format.height_px;
  if (width < 1 || height < 1 || width > kMaxWidth_px || height > kMaxHeight_px ||
      width % even_width != 0 || height % even_height != 0)
    return "delivers " + std::to_string(width) + "x" + std::to_string(height) +
           ", but allowed are even sizes up to 1920x1080";
  return "";
}

/// Returns a view of `bytes` as the rows of a picture. `divisor`: how much smaller it is.
cv::Mat viewRows(const V4l2Format& format, std::uint32_t divisor, int type,
                 std::span<const std::uint8_t> bytes, std::uint64_t stride) {
  return {static_cast<int>(format.height_px / divisor), static_cast<int>(format.width_px / divisor),
          type, const_cast<std::uint8_t*>(bytes.data()), stride};
}

/// Reads a format whose pixels lie one after the other, `channels` bytes each.
ImageResult readPacked(const V4l2Format& format, std::uint32_t even_width, int channels,
                       int conversion, std::span<const std::uint8_t> bytes) {
  if (std::string problem = findSizeProblem(format, even_width, 1); !problem.empty())
    return {{}, problem};
  const Rows rows =
      findRows(format, std::uint64_t{format.width_px} * static_cast<std::uint64_t>(channels),
               format.height_px, bytes);
  if (!rows.problem.empty()) return {{}, rows.problem};
  cv::Mat color;
  const cv::Mat raw = viewRows(format, 1, CV_8UC(channels), bytes, rows.stride);
  if (conversion < 0)
    raw.copyTo(color);
  else
    cv::cvtColor(raw, color, conversion);
  return {color, ""};
}

// A plane of brightness, then one of colours with half the rows.
ImageResult readNv12(const V4l2Format& format, std::span<const std::uint8_t> bytes) {
  if (std::string problem = findSizeProblem(format, 2, 2); !problem.empty()) return {{}, problem};
  const std::uint64_t height = format.height_px;
  const Rows rows = findRows(format, format.width_px, height + height / 2, bytes);
  if (!rows.problem.empty()) return {{}, rows.problem};
  cv::Mat color;
  cv::cvtColorTwoPlane(
      viewRows(format, 1, CV_8UC1, bytes, rows.stride),
      viewRows(format, 2, CV_8UC2, bytes.subspan(rows.stride * height), rows.stride), color,
      cv::COLOR_YUV2BGR_NV12);
  return {color, ""};
}

// A plane of brightness, then two of colours with half the rows and columns.
ImageResult readI420(const V4l2Format& format, std::span<const std::uint8_t> bytes) {
  if (std::string problem = findSizeProblem(format, 2, 2); !problem.empty()) return {{}, problem};
  V4l2Format whole = format;  // as OpenCV sees it: one picture of brightness, half as high again
  whole.height_px += format.height_px / 2;
  const Rows rows = findRows(whole, format.width_px, whole.height_px, bytes);
  if (!rows.problem.empty()) return {{}, rows.problem};
  if (rows.stride != format.width_px) return {{}, "delivers YU12 with gaps between its rows"};
  cv::Mat color;
  cv::cvtColor(viewRows(whole, 1, CV_8UC1, bytes, rows.stride), color, cv::COLOR_YUV2BGR_I420);
  return {color, ""};
}

ImageResult readMotionJpeg(const V4l2Format& format, std::span<const std::uint8_t> bytes) {
  const auto size = jpegSize(bytes);
  if (!size) return {{}, "delivers no whole JPEG picture"};
  if (*size != PictureSize{format.width_px, format.height_px})
    return {{},
            "delivers a JPEG picture of " + std::to_string(size->width_px) + "x" +
                std::to_string(size->height_px) + " instead of " + std::to_string(format.width_px) +
                "x" + std::to_string(format.height_px)};
  ImageResult picture = decodeImage(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (!picture.ok()) picture.problem = "delivers a JPEG picture that " + picture.problem;
  return picture;
}

}  // namespace

ImageResult readV4l2Color(const V4l2Format& format, std::span<const std::uint8_t> bytes) {
  switch (format.code) {
    case fourCc("YUYV"):
      return readPacked(format, 2, 2, cv::COLOR_YUV2BGR_YUYV, bytes);
    case fourCc("UYVY"):
      return readPacked(format, 2, 2, cv::COLOR_YUV2BGR_UYVY, bytes);
    case fourCc("BGR3"):
      return readPacked(format, 1, 3, -1, bytes);
    case fourCc("RGB3"):
      return readPacked(format, 1, 3, cv::COLOR_RGB2BGR, bytes);
    case fourCc("YU12"):
      return readI420(format, bytes);
    case fourCc("NV12"):
      return readNv12(format, bytes);
    case fourCc("MJPG"):
    case fourCc("JPEG"):
      return readMotionJpeg(format, bytes);
    default:
      return {{}, "delivers colour in an unknown format"};
  }
}

ImageResult readV4l2Depth(const V4l2Format& format, std::span<const std::uint8_t> bytes) {
  if (std::find(std::begin(kDepthCodes), std::end(kDepthCodes), format.code) ==
      std::end(kDepthCodes))
    return {{}, "delivers depth in an unknown format"};
  if (findDepthKind(format.code) == DepthKind::kHeight) {
    ImageResult grey = format.code == fourCc("GREY") ? readPacked(format, 1, 1, -1, bytes)
                                                     : readV4l2Color(format, bytes);
    if (!grey.ok()) return grey;
    if (grey.image.channels() == 3 && isColorCoded(grey.image))
      return {{}, "delivers depth as colours"};
    return toDepth(grey.image, {DepthKind::kHeight});
  }
  if (std::string problem = findSizeProblem(format, 1, 1); !problem.empty()) return {{}, problem};
  const Rows rows = findRows(format, 2ULL * format.width_px, format.height_px, bytes);
  if (!rows.problem.empty()) return {{}, rows.problem};
  // Copies row by row: the rows of a device need not begin at even addresses.
  cv::Mat raw(static_cast<int>(format.height_px), static_cast<int>(format.width_px), CV_16UC1);
  viewRows(format, 1, CV_8UC2, bytes, rows.stride)
      .copyTo(cv::Mat(raw.rows, raw.cols, CV_8UC2, raw.data, raw.step));
  cv::Mat depth;
  raw.convertTo(depth, CV_32F);
  return {depth, ""};
}

}  // namespace hapticast::server
