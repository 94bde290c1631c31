// SPDX-License-Identifier: MIT
// What goes to many viewers, encoded once: shared immutable bytes with the length prefix in front.
#pragma once

#include <cstdint>
#include <optional>

#include "common/haptic_frame.hpp"
#include "common/wire/framing.hpp"
#include "common/wire/messages.hpp"

namespace hapticast::server {

struct EncodedFrame {
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes lean;  ///< for who got the frame before: reliefs that did not change are left out
  SharedBytes full;  ///< for who joined or lost one: every relief
};

struct EncodedVideo {
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes bytes;
};

/// Makes the bytes of frames; remembers when all reliefs were sent last. Thread: one (the
/// pipeline's).
class FrameEncoder {
 public:
  /// `frame` carries every relief; its objects' `changed_in_frame` say which are new. Reliefs that
  /// did not change are repeated every second of media time and at every new epoch.
  [[nodiscard]] EncodedFrame encode(const HapticFrame& frame);

 private:
  std::optional<MediaTime> last_full_;
  std::uint32_t epoch_ = 0;
};

/// Requires a JPEG of at most 4 MiB.
[[nodiscard]] EncodedVideo encodeVideo(VideoFrame video);

}  // namespace hapticast::server
