// SPDX-License-Identifier: MIT
#include "server/source/recording/image_message.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/source/recording/cdr_in.hpp"
#include "server/source/recording/foxglove_message.hpp"

namespace hapticast::server {

namespace {

struct TypeName {
  std::string_view encoding;  ///< of the message
  std::string_view schema;
  MessageType type;
};

constexpr std::array kTypeNames{
    TypeName{"cdr", "sensor_msgs/msg/Image", MessageType::kRosImage},
    TypeName{"cdr", "sensor_msgs/msg/CompressedImage", MessageType::kRosCompressedImage},
    TypeName{"cdr", "sensor_msgs/msg/CameraInfo", MessageType::kRosCameraInfo},
    TypeName{"protobuf", "foxglove.RawImage", MessageType::kFoxgloveImage},
    TypeName{"protobuf", "foxglove.CompressedImage", MessageType::kFoxgloveCompressedImage},
    TypeName{"protobuf", "foxglove.CameraCalibration", MessageType::kFoxgloveCalibration},
};

/// Reads std_msgs/msg/Header: int32 sec, uint32 nanosec, string frame_id.
void readHeader(CdrIn& in, ImageMessage& image) {
  const std::int64_t seconds = in.int32();
  image.stamp_ns = toStamp_ns(seconds, in.uint32());
  image.frame_id = in.text();
}

ImageMessage readRosImage(CdrIn& in) {
  ImageMessage image;
  readHeader(in, image);
  image.height_px = in.uint32();
  image.width_px = in.uint32();
  image.encoding = in.text();
  image.big_endian = in.uint8() != 0;
  image.row_bytes = in.uint32();
  image.data = in.bytes();
  return image;
}

ImageMessage readRosCompressedImage(CdrIn& in) {
  ImageMessage image;
  image.is_compressed = true;
  readHeader(in, image);
  image.encoding = in.text();
  image.data = in.bytes();
  return image;
}

/// Reads sensor_msgs/msg/CameraInfo up to its matrix k.
std::optional<CameraMessage> readRosCamera(std::span<const std::uint8_t> bytes) {
  CdrIn in(bytes);
  ImageMessage header;
  readHeader(in, header);
  CameraMessage camera;
  camera.height_px = in.uint32();
  camera.width_px = in.uint32();
  (void)in.text();  // model of the distortion
  in.skipFloats();  // its parameters
  std::array<double, 9> k{};
  for (double& value : k) value = in.float64();
  if (!in.problem().empty()) return std::nullopt;
  return withMatrix(camera, k);
}

}  // namespace

std::optional<MessageType> findType(const McapChannel& channel) {
  const auto* const found =
      std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& name) {
        return channel.message_encoding == name.encoding && channel.schema.name == name.schema;
      });
  return found == kTypeNames.end() ? std::nullopt : std::optional(found->type);
}

bool isCameraType(MessageType type) {
  return type == MessageType::kRosCameraInfo || type == MessageType::kFoxgloveCalibration;
}

Result<ImageMessage> readImageMessage(MessageType type, std::span<const std::uint8_t> bytes) {
  if (type == MessageType::kFoxgloveImage || type == MessageType::kFoxgloveCompressedImage)
    return readFoxgloveImage(type, bytes);
  CdrIn in(bytes);
  ImageMessage image =
      type == MessageType::kRosImage ? readRosImage(in) : readRosCompressedImage(in);
  if (!in.problem().empty()) return Error{in.problem()};
  return image;
}

std::optional<CameraMessage> readCameraMessage(MessageType type,
                                               std::span<const std::uint8_t> bytes) {
  return type == MessageType::kRosCameraInfo ? readRosCamera(bytes) : readFoxgloveCamera(bytes);
}

}  // namespace hapticast::server
