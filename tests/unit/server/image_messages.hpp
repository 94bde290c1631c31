// SPDX-License-Identifier: MIT
// Messages with images as other programs write them: CDR of ROS 2 in both byte orders, and protobuf
// of Foxglove. Shares no code with the server.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "common/recording/mcap_writer.hpp"

namespace hapticast::server {

using MessageBytes = std::vector<std::uint8_t>;

/// Writes CDR: each number stands at a multiple of its size, behind four bytes of head.
class CdrOut {
 public:
  explicit CdrOut(bool big_endian = false)
      : bytes_{0, static_cast<std::uint8_t>(big_endian ? 0 : 1), 0, 0}, big_endian_(big_endian) {}
  CdrOut& uint8(std::uint8_t value) { return number(value, 1); }
  CdrOut& uint32(std::uint32_t value) { return number(value, 4); }
  CdrOut& float64(double value) { return number(std::bit_cast<std::uint64_t>(value), 8); }
  CdrOut& text(const std::string& value) {
    uint32(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.c_str(), value.c_str() + value.size() + 1);
    return *this;
  }
  CdrOut& bytes(const MessageBytes& value) {
    uint32(static_cast<std::uint32_t>(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  [[nodiscard]] const MessageBytes& message() const { return bytes_; }

 private:
  CdrOut& number(std::uint64_t value, std::size_t size) {
    while ((bytes_.size() - 4) % size != 0) bytes_.push_back(0xEE);
    for (std::size_t i = 0; i < size; ++i)
      bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * (big_endian_ ? size - 1 - i : i)));
    return *this;
  }
  MessageBytes bytes_;
  bool big_endian_;
};

/// How a message of ROS 2 is written.
struct RosForm {
  std::int64_t stamp_ns = 1'500'000'000;
  std::string frame_id = "camera";
  bool big_endian_cdr = false;
  bool big_endian_pixels = false;
  std::uint32_t padding_bytes = 0;  ///< behind each row
};

inline CdrOut rosHeader(const RosForm& form) {
  CdrOut out(form.big_endian_cdr);
  out.uint32(static_cast<std::uint32_t>(form.stamp_ns / 1'000'000'000));
  out.uint32(static_cast<std::uint32_t>(form.stamp_ns % 1'000'000'000));
  out.text(form.frame_id);
  return out;
}

/// Returns the rows of `pixels` with padding, and each value in the order of bytes of `form`.
inline MessageBytes rowBytes(const cv::Mat& pixels, const RosForm& form) {
  MessageBytes data;
  const std::size_t size = pixels.elemSize1();
  for (int v = 0; v < pixels.rows; ++v) {
    const std::uint8_t* const row = pixels.ptr(v);
    for (std::size_t i = 0; i < pixels.elemSize() * std::size_t(pixels.cols); ++i) {
      const std::size_t value = i - i % size;
      data.push_back(row[form.big_endian_pixels ? value + size - 1 - i % size : i]);
    }
    data.insert(data.end(), form.padding_bytes, 0xAA);
  }
  return data;
}

inline MessageBytes rosImage(const cv::Mat& pixels, const std::string& encoding,
                             const RosForm& form = {}) {
  CdrOut out = rosHeader(form);
  out.uint32(std::uint32_t(pixels.rows)).uint32(std::uint32_t(pixels.cols)).text(encoding);
  out.uint8(form.big_endian_pixels ? 1 : 0);
  out.uint32(std::uint32_t(pixels.elemSize()) * std::uint32_t(pixels.cols) + form.padding_bytes);
  return out.bytes(rowBytes(pixels, form)).message();
}

inline MessageBytes rosCompressed(const MessageBytes& file, const std::string& format,
                                  const RosForm& form = {}) {
  return rosHeader(form).text(format).bytes(file).message();
}

inline MessageBytes rosCameraInfo(cv::Size size, double focal_px, const RosForm& form = {}) {
  CdrOut out = rosHeader(form);
  out.uint32(std::uint32_t(size.height)).uint32(std::uint32_t(size.width)).text("plumb_bob");
  out.uint32(5);
  for (int i = 0; i < 5; ++i) out.float64(0.01 * i);
  for (const double value :
       {focal_px, 0.0, 0.5 * size.width, 0.0, 2.0 * focal_px, 0.25 * size.height, 0.0, 0.0, 1.0})
    out.float64(value);
  for (int i = 0; i < 21; ++i) out.float64(1.0);  // r, p
  for (int i = 0; i < 6; ++i) out.uint32(0);      // binning, roi
  return out.uint8(0).message();
}

inline MessageBytes encodeFile(const std::string& ending, const cv::Mat& picture) {
  MessageBytes file;
  cv::imencode(ending, picture, file);
  return file;
}

/// Returns the data of compressedDepth: a head of 12 bytes (format, A, B), and a PNG.
inline MessageBytes pluginDepth(const cv::Mat& values, float a = 0.0F, float b = 0.0F) {
  MessageBytes data{1, 0, 0, 0};
  for (const float each : {a, b}) {
    const auto bits = std::bit_cast<std::uint32_t>(each);
    for (unsigned i = 0; i < 4; ++i) data.push_back(static_cast<std::uint8_t>(bits >> 8 * i));
  }
  const MessageBytes png = encodeFile(".png", values);
  data.insert(data.end(), png.begin(), png.end());
  return data;
}

/// Writes protobuf.
class ProtoOut {
 public:
  ProtoOut& varint(std::uint64_t field, std::uint64_t value) { return put(field << 3).put(value); }
  ProtoOut& fixed32(std::uint64_t field, std::uint32_t value) {
    put(field << 3 | 5);
    for (unsigned i = 0; i < 4; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * i));
    return *this;
  }
  ProtoOut& bytes(std::uint64_t field, const MessageBytes& value) {
    put(field << 3 | 2).put(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  ProtoOut& text(std::uint64_t field, const std::string& value) {
    return bytes(field, MessageBytes(value.begin(), value.end()));
  }
  [[nodiscard]] const MessageBytes& message() const { return bytes_; }

 private:
  ProtoOut& put(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
    bytes_.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  MessageBytes bytes_;
};

inline MessageBytes protoStamp(std::int64_t stamp_ns) {
  return ProtoOut()
      .varint(1, std::uint64_t(stamp_ns / 1'000'000'000))
      .varint(2, std::uint64_t(stamp_ns % 1'000'000'000))
      .message();
}

inline MessageBytes foxgloveImage(const cv::Mat& pixels, const std::string& encoding,
                                  std::int64_t stamp_ns = 1'500'000'000) {
  return ProtoOut()
      .bytes(1, protoStamp(stamp_ns))
      .fixed32(2, std::uint32_t(pixels.cols))
      .fixed32(3, std::uint32_t(pixels.rows))
      .text(4, encoding)
      .fixed32(5, std::uint32_t(pixels.elemSize()) * std::uint32_t(pixels.cols))
      .bytes(6, rowBytes(pixels, {}))
      .text(7, "camera")
      .message();
}

inline MessageBytes foxgloveCompressed(const MessageBytes& file, const std::string& format,
                                       std::int64_t stamp_ns = 1'500'000'000) {
  return ProtoOut()
      .bytes(1, protoStamp(stamp_ns))
      .bytes(2, file)
      .text(3, format)
      .text(4, "camera")
      .message();
}

inline MessageBytes foxgloveCalibration(cv::Size size, double focal_px) {
  MessageBytes k;
  for (const double value :
       {focal_px, 0.0, 0.5 * size.width, 0.0, 2.0 * focal_px, 0.25 * size.height, 0.0, 0.0, 1.0}) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned i = 0; i < 8; ++i) k.push_back(static_cast<std::uint8_t>(bits >> 8 * i));
  }
  return ProtoOut()
      .fixed32(2, std::uint32_t(size.width))
      .fixed32(3, std::uint32_t(size.height))
      .text(4, "plumb_bob")
      .bytes(6, k)
      .message();
}

inline McapChannel rosChannel(const std::string& topic, const std::string& type) {
  return {topic, "cdr", {"sensor_msgs/msg/" + type, "ros2msg", ""}};
}

inline McapChannel foxgloveChannel(const std::string& topic, const std::string& type) {
  return {topic, "protobuf", {"foxglove." + type, "protobuf", ""}};
}

}  // namespace hapticast::server
