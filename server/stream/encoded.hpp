// SPDX-License-Identifier: MIT
// Encoded frames and pictures. Each is encoded once into constant bytes, which all viewers share.
// Channels add the framing. Thread: any, except FrameEncoder.
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
#include "server/stream/frame_signer.hpp"

namespace hapticast::server {

/// One frame as a key frame, for viewers that have just joined or lost the previous frame. Most key
/// frames are never needed, so only the first call of payload() encodes it. Thread: any.
class LazyKeyFrame {
 public:
  /// `signer` signs the message and must outlive the object; null: no signature.
  LazyKeyFrame(CodedFrame frame, FrameSigner* signer) : signer_(signer), frame_(std::move(frame)) {}
  /// Creates a key frame from bytes that are encoded already.
  explicit LazyKeyFrame(SharedBytes payload) : payload_(std::move(payload)) {}

  /// Returns the encoded key frame. The first call encodes it.
  [[nodiscard]] SharedBytes payload();

 private:
  std::mutex mutex_;
  FrameSigner* signer_ = nullptr;
  std::optional<CodedFrame> frame_;  // the frame until payload() encodes it
  SharedBytes payload_;
};

/// Age, in media time, beyond which a frame has no use if a newer one exists. Chosen: force fades
/// when frames are so late.
inline constexpr Duration kStaleAge = std::chrono::milliseconds(250);

/// A frame in all encoded forms that viewers need.
struct EncodedFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes delta;                        ///< delta frame, for viewers that have the frame before
  std::shared_ptr<LazyKeyFrame> key_frame;  ///< never null
  SignedDatagrams datagrams = nullptr;      ///< datagrams of the delta frame; null: none
  bool too_many_datagrams =
      false;  ///< datagrams were requested, but the frame is too large for them
};

/// A picture, encoded for all viewers.
struct EncodedVideo {
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes payload;
};

/// Size of each object's encoded reliefs in the last frame that contained them, by object id,
/// bytes.
using ReliefBytes = std::map<std::uint32_t, std::size_t>;

/// Encodes frames and decides which of them contain all reliefs. Thread: one (the encoder's).
class FrameEncoder {
 public:
  /// Returns `frame` in encoded form. `frame` has every relief. The delta frame leaves out the
  /// reliefs that did not change in this frame (`changed_in_frame`). Once a second of media time,
  /// at each new epoch and after a hole, it contains all reliefs. `slices`: settings of the height
  /// codec. `signer`: signs the frame and must outlive the result; null: no signature and no
  /// datagrams. `datagrams`: if true, the result also has datagrams.
  [[nodiscard]] EncodedFrame encode(const HapticFrame& frame, const SliceSettings& slices = {},
                                    FrameSigner* signer = nullptr, bool datagrams = true);
  /// Does the same with a frame whose reliefs are coded.
  [[nodiscard]] EncodedFrame encode(CodedFrame frame, FrameSigner* signer = nullptr,
                                    bool datagrams = true);
  [[nodiscard]] const ReliefBytes& reliefBytes() const { return relief_bytes_; }

 private:
  /// Returns whether frames before `media_time` are missing, because the server stood still. The
  /// viewers may not have received the last ones before that hole.
  [[nodiscard]] bool followsHole(MediaTime media_time);

  FrameCoder coder_;
  ReliefBytes relief_bytes_;  // sizes in the last frame
  std::optional<MediaTime> last_key_frame_;
  MediaTime last_media_time_;
  Duration last_gap_{0};
  std::uint32_t epoch_ = 0;
};

/// Returns the picture `video` in encoded form. Requires a JPEG of at most 4 MiB.
[[nodiscard]] EncodedVideo encodeVideo(VideoFrame video);

}  // namespace hapticast::server
