// SPDX-License-Identifier: MIT
// Messages with images in recordings of ROS 2 (CDR) and Foxglove (protobuf): one byte with the
// type, then the message. Whatever they are, a picture has a size that sources read, or a problem.
#include <cstdint>
#include <span>

#include "server/source/recording/image_message.hpp"
#include "server/source/recording/message_picture.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::cdr {
namespace {

using namespace hapticast::server;

void check(const ImageResult& result, bool right_type) {
  require(result.ok() != result.image.empty());
  require(!result.ok() || (right_type && sizeReadable(result.image.cols, result.image.rows)));
}

}  // namespace

HAPTICAST_FUZZ_TARGET("cdr") {
  constexpr auto kTypes = static_cast<std::uint8_t>(MessageType::kFoxgloveCalibration) + 1;
  if (size == 0) return 0;
  const auto type = static_cast<MessageType>(data[0] % kTypes);
  const std::span<const std::uint8_t> message(data + 1, size - 1);
  if (isCameraType(type)) {
    const auto camera = readCameraMessage(type, message);
    require(!camera || (camera->camera.fx_px >= 1.0 && camera->camera.fy_px >= 1.0));
    return 0;
  }
  const auto image = readImageMessage(type, message);
  if (!image.ok()) return 0;
  const KindResult kind = findKind(image.value());
  require((kind.kind == ImageKind::kUnknown) != kind.problem.empty());
  const ImageResult color = readColor(image.value());
  check(color, color.image.type() == CV_8UC3);
  const ImageResult depth = readDepth(image.value());
  check(depth, depth.image.type() == CV_16UC1 || depth.image.type() == CV_32FC1);
  return 0;
}

}  // namespace hapticast::fuzz::cdr
