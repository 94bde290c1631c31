// SPDX-License-Identifier: MIT
// What goes to many viewers, encoded once: shared immutable payloads. How they are framed is the
// affair of the channel that takes them.
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

/// A frame with every relief, for who joins or lost the frame before: most frames are never asked
/// for it, so it becomes bytes at the first call. Thread: any.
class LazyKeyFrame {
 public:
  explicit LazyKeyFrame(CodedFrame frame) : frame_(std::move(frame)) {}
  /// Its bytes are there already.
  explicit LazyKeyFrame(SharedBytes payload) : payload_(std::move(payload)) {}

  [[nodiscard]] SharedBytes payload();

 private:
  std::mutex mutex_;
  std::optional<CodedFrame> frame_;  // until it is bytes
  SharedBytes payload_;
};

/// A frame's datagrams without their tokens, signed.
using SignedDatagrams = std::shared_ptr<const std::vector<std::vector<std::uint8_t>>>;

struct EncodedFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes delta;  ///< for who got the frame before: reliefs that did not change are left out
  std::shared_ptr<LazyKeyFrame> key_frame;  ///< never null
  SignedDatagrams datagrams = nullptr;      ///< the lean frame's; null: nobody takes them
  bool too_many_datagrams = false;          ///< somebody takes them, but the frame is too large
};

class DatagramSigner;

struct EncodedVideo {
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes payload;
};

/// Of each object's reliefs as they were last sent, by its id.
using ReliefBytes = std::map<std::uint32_t, std::size_t>;

/// Makes the bytes of frames; remembers when all reliefs were sent last. Thread: one (the
/// encoder's).
class FrameEncoder {
 public:
  /// `frame` carries every relief; its objects' `changed_in_frame` say which are new. Reliefs that
  /// did not change are repeated every second of media time and at every new epoch.
  /// `signer`: makes datagrams as well.
  [[nodiscard]] EncodedFrame encode(const HapticFrame& frame, const SliceSettings& slices = {},
                                    DatagramSigner* signer = nullptr);
  [[nodiscard]] const ReliefBytes& reliefBytes() const { return relief_bytes_; }

 private:
  FrameCoder coder_;
  ReliefBytes relief_bytes_;  // of the last frame
  std::optional<MediaTime> last_key_frame_;
  std::uint32_t epoch_ = 0;
};

/// Requires a JPEG of at most 4 MiB.
[[nodiscard]] EncodedVideo encodeVideo(VideoFrame video);

}  // namespace hapticast::server
