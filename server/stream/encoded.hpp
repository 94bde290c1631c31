// SPDX-License-Identifier: MIT
// Encoded stream items: frames and pictures, encoded once and shared as immutable payloads by all
// viewers. Channels add the framing. Thread: any, except FrameEncoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/haptic_frame.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/framing.hpp"

namespace hapticast::server {

/// Key frame, for viewers that joined or lost the frame before. Most are never needed, so the first
/// call of payload() encodes it. Thread: any.
class LazyKeyFrame {
 public:
  explicit LazyKeyFrame(CodedFrame frame) : frame_(std::move(frame)) {}
  /// Uses bytes that exist already.
  explicit LazyKeyFrame(SharedBytes payload) : payload_(std::move(payload)) {}

  /// Returns the encoded key frame; encodes it at the first call.
  [[nodiscard]] SharedBytes payload();

 private:
  std::mutex mutex_;
  std::optional<CodedFrame> frame_;  // until its encoding
  SharedBytes payload_;
};

/// A frame's signed datagrams, without their tokens.
using SignedDatagrams = std::shared_ptr<const std::vector<std::vector<std::uint8_t>>>;

/// A frame in all forms that viewers need.
struct EncodedFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes delta;                        ///< delta frame, for viewers with the frame before
  std::shared_ptr<LazyKeyFrame> key_frame;  ///< never null
  SignedDatagrams datagrams = nullptr;      ///< datagrams of the delta frame; null: none
  bool too_many_datagrams = false;          ///< datagrams are wanted, but the frame is too large
};

class DatagramSigner;

/// A picture, encoded for all viewers.
struct EncodedVideo {
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes payload;
};

/// Bytes of each object's reliefs in the last frame that sent them, by object id.
using ReliefBytes = std::map<std::uint32_t, std::size_t>;

/// Encodes frames; decides when all reliefs are repeated. Thread: one (the encoder's).
class FrameEncoder {
 public:
  /// Encodes `frame`, which has every relief; `changed_in_frame` of its objects marks the new ones.
  /// Unchanged reliefs are repeated every second of media time and at every new epoch. `signer`:
  /// signs datagrams too; may be null.
  [[nodiscard]] EncodedFrame encode(const HapticFrame& frame, const SliceSettings& slices = {},
                                    DatagramSigner* signer = nullptr);
  [[nodiscard]] const ReliefBytes& reliefBytes() const { return relief_bytes_; }

 private:
  FrameCoder coder_;
  ReliefBytes relief_bytes_;  // of the last frame
  std::optional<MediaTime> last_key_frame_;
  std::uint32_t epoch_ = 0;
};

/// Encodes a picture. Requires a JPEG of at most 4 MiB.
[[nodiscard]] EncodedVideo encodeVideo(VideoFrame video);

}  // namespace hapticast::server
