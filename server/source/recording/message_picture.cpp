// SPDX-License-Identifier: MIT
#include "server/source/recording/message_picture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

/// An encoding of raw pixels (sensor_msgs/image_encodings.hpp of ROS 2, foxglove.RawImage).
struct RawEncoding {
  std::string_view name;
  ImageKind kind;
  int type;    ///< of OpenCV
  int to_bgr;  ///< cv::ColorConversionCodes; kNoConversion: the pixels are BGR, or depth
};
constexpr int kNoConversion = -1;

constexpr std::array kRawEncodings{
    RawEncoding{"rgb8", ImageKind::kColor, CV_8UC3, cv::COLOR_RGB2BGR},
    RawEncoding{"bgr8", ImageKind::kColor, CV_8UC3, kNoConversion},
    RawEncoding{"8UC3", ImageKind::kColor, CV_8UC3, kNoConversion},
    RawEncoding{"rgba8", ImageKind::kColor, CV_8UC4, cv::COLOR_RGBA2BGR},
    RawEncoding{"bgra8", ImageKind::kColor, CV_8UC4, cv::COLOR_BGRA2BGR},
    RawEncoding{"mono8", ImageKind::kColor, CV_8UC1, cv::COLOR_GRAY2BGR},
    RawEncoding{"8UC1", ImageKind::kColor, CV_8UC1, cv::COLOR_GRAY2BGR},
    RawEncoding{"16UC1", ImageKind::kDepth, CV_16UC1, kNoConversion},
    RawEncoding{"mono16", ImageKind::kDepth, CV_16UC1, kNoConversion},
    RawEncoding{"32FC1", ImageKind::kDepth, CV_32FC1, kNoConversion},
};

const RawEncoding* findEncoding(std::string_view name) {
  const auto* const found =
      std::find_if(kRawEncodings.begin(), kRawEncodings.end(),
                   [name](const RawEncoding& encoding) { return encoding.name == name; });
  return found == kRawEncodings.end() ? nullptr : found;
}

std::string unknownEncoding(const ImageMessage& image) {
  return "has the encoding " + quote(image.encoding) + ", which the server does not read";
}

/// Reverses the bytes of each value.
void swapBytes(cv::Mat& picture) {
  const std::size_t size = picture.elemSize1();
  std::uint8_t* const begin = picture.data;  // a picture of its own has no gaps between rows
  std::uint8_t* const end = begin + picture.total() * picture.elemSize();
  for (std::uint8_t* value = begin; value < end; value += size) std::reverse(value, value + size);
}

ImageResult readPixels(const ImageMessage& image, const RawEncoding& encoding) {
  if (image.width_px == 0 || image.height_px == 0) return {{}, "has no pixels"};
  if (!sizeReadable(image.width_px, image.height_px))
    return {{}, describeTooLarge(image.width_px, image.height_px)};
  const std::uint64_t pixel_bytes = CV_ELEM_SIZE(encoding.type);
  const std::uint64_t used_bytes = pixel_bytes * image.width_px;
  if (image.row_bytes < used_bytes) return {{}, "has rows that are shorter than its pixels"};
  if (image.row_bytes % CV_ELEM_SIZE1(encoding.type) != 0)
    return {{}, "has rows of an odd number of bytes"};
  if (std::uint64_t{image.row_bytes} * (image.height_px - 1) + used_bytes > image.data.size())
    return {{}, "has less data than its size needs"};
  const cv::Mat view(static_cast<int>(image.height_px), static_cast<int>(image.width_px),
                     encoding.type, const_cast<std::uint8_t*>(image.data.data()), image.row_bytes);
  cv::Mat picture;
  if (encoding.to_bgr == kNoConversion) {
    picture = view.clone();
  } else {
    cv::cvtColor(view, picture, encoding.to_bgr);
  }
  if (image.big_endian && picture.elemSize1() > 1) swapBytes(picture);
  return {picture, ""};
}

bool isDepthPlugin(const ImageMessage& image) {
  return image.is_compressed && image.encoding.find("compressedDepth") != std::string_view::npos;
}

ImageResult requireDepth(ImageResult result) {
  if (result.ok() && result.image.type() != CV_16UC1 && result.image.type() != CV_32FC1)
    return {{}, "has pictures of colour, not depth of 16 bits or of floats"};
  return result;
}

/// Reads what the plugin compressed_depth_image_transport of ROS writes: the number of the format
/// (int32), A and B (float32), all little-endian, then a PNG of 16 bits.
ImageResult readPluginDepth(const ImageMessage& image) {
  if (image.encoding.find("rvl") != std::string_view::npos)
    return {{}, "is compressed as RVL, which the server does not read; record it with png"};
  McapIn in(image.data);
  (void)in.number<std::uint32_t>();
  const auto a = std::bit_cast<float>(in.number<std::uint32_t>());
  const auto b = std::bit_cast<float>(in.number<std::uint32_t>());
  ImageResult result = requireDepth(decodeImage(in.rest(), cv::IMREAD_UNCHANGED));
  const bool is_inverse = image.encoding.starts_with("32FC1");
  if (!result.ok() || !is_inverse || result.image.type() != CV_16UC1) return result;
  cv::Mat depth_m(result.image.size(), CV_32FC1);
  std::transform(result.image.begin<std::uint16_t>(), result.image.end<std::uint16_t>(),
                 depth_m.begin<float>(), [a, b](std::uint16_t value) {
                   return value == 0 ? 0.0F : a / (static_cast<float>(value) - b);
                 });
  return {depth_m, ""};
}

}  // namespace

KindResult findKind(const ImageMessage& image) {
  if (isDepthPlugin(image)) return {ImageKind::kDepth, ""};
  if (!image.is_compressed) {
    const RawEncoding* const encoding = findEncoding(image.encoding);
    if (encoding == nullptr) return {ImageKind::kUnknown, unknownEncoding(image)};
    return {encoding->kind, ""};
  }
  const ImageResult result = decodeImage(image.data, cv::IMREAD_UNCHANGED);
  if (!result.ok()) return {ImageKind::kUnknown, result.problem};
  return {requireDepth(result).ok() ? ImageKind::kDepth : ImageKind::kColor, ""};
}

ImageResult readColor(const ImageMessage& image) {
  if (isDepthPlugin(image)) return {{}, "has depth, not colour"};
  if (image.is_compressed) {
    ImageResult color = decodeImage(image.data, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    if (color.ok() && color.image.type() != CV_8UC3) return {{}, "has numbers, not colours"};
    return color;
  }
  const RawEncoding* const encoding = findEncoding(image.encoding);
  if (encoding == nullptr) return {{}, unknownEncoding(image)};
  if (encoding->kind != ImageKind::kColor) return {{}, "has depth, not colour"};
  return readPixels(image, *encoding);
}

ImageResult readDepth(const ImageMessage& image) {
  if (isDepthPlugin(image)) return readPluginDepth(image);
  if (image.is_compressed) return requireDepth(decodeImage(image.data, cv::IMREAD_UNCHANGED));
  const RawEncoding* const encoding = findEncoding(image.encoding);
  if (encoding == nullptr) return {{}, unknownEncoding(image)};
  if (encoding->kind != ImageKind::kDepth) return {{}, "has colours, not depth"};
  return readPixels(image, *encoding);
}

}  // namespace hapticast::server
