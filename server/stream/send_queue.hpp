// SPDX-License-Identifier: MIT
// Queue of the items to send to one viewer. If the viewer is slow, the oldest frames are dropped,
// so that the newest are sent and memory is bounded. It has no sockets and no clocks. Thread: the
// network's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "server/stream/encoded.hpp"
#include "server/stream/picture_pacer.hpp"

namespace hapticast::server {

/// Counts of sent and dropped items since the queue's creation.
struct SendCounts {
  std::uint64_t frames_sent = 0;
  std::uint64_t videos_sent = 0;
  std::uint64_t frames_dropped_full = 0;  ///< dropped because kMaxFrames newer frames waited
  /// Dropped because they were more than kMaxAge older than the newest.
  std::uint64_t frames_dropped_old = 0;
  std::uint64_t videos_dropped = 0;  ///< dropped because a newer picture replaced them

  SendCounts& operator+=(const SendCounts& other);
  [[nodiscard]] std::uint64_t dropped() const {
    return frames_dropped_full + frames_dropped_old + videos_dropped;
  }
};

/// Queue of the items that wait for one viewer.
class SendQueue {
 public:
  static constexpr std::size_t kMaxFrames = 3;  ///< largest number of frames in the queue
  /// Largest age of a frame relative to the newest frame, in media time.
  static constexpr Duration kMaxAge = kStaleAge;
  /// Largest number of control messages in the queue.
  static constexpr std::size_t kMaxControl = 64;

  /// From now on pictures leave in parts, each when the pacer permits it.
  void sendPicturesInParts() { pacer_.emplace(); }
  [[nodiscard]] bool sendsPicturesInParts() const { return pacer_.has_value(); }
  /// Adds a control message. Returns false if kMaxControl messages wait already: the viewer then
  /// sends requests without reading the answers.
  [[nodiscard]] bool pushControl(SharedBytes payload);
  /// Sets the stream's description to send. It replaces a description that still waits.
  void pushDescription(SharedBytes payload) { description_ = std::move(payload); }
  /// Adds a frame. Drops the oldest frames if there are more than kMaxFrames, or if they are older
  /// than kMaxAge. After a drop, the next frame is sent as a key frame.
  void pushFrame(EncodedFrame frame);
  /// Sets the picture to send. It replaces a picture that still waits.
  void pushVideo(EncodedVideo video);
  /// Counts a picture that is not sent, because the link is too slow for it.
  void dropPicture() { ++counts_.videos_dropped; }
  /// Drops the frames that wait, because the stream leaves out the frame after them. The next frame
  /// is sent as a key frame.
  void requireKeyFrame();
  /// Removes the pictures.
  void clearPictures();
  /// Removes all frames and pictures. Call it when viewers can no longer use them, for example
  /// after a change of the workspace. The next frame is sent as a key frame.
  void clearFrames();
  /// Removes all items. The next frame is sent as a key frame.
  void clear();

  /// Returns whether pop() may return null. Parts of a picture may have to wait, so they do not
  /// count.
  [[nodiscard]] bool empty() const {
    return control_.empty() && !description_ && frames_.empty() && (!video_ || pacer_);
  }
  /// Returns whether the next item of pop() is a control message.
  [[nodiscard]] bool controlWaits() const { return !control_.empty(); }
  /// Returns the bytes to send for `frame` and counts the frame as sent. The effect is that of
  /// pushFrame() and then pop(), but the queue is not used. Requires an empty queue.
  [[nodiscard]] SharedBytes pass(const EncodedFrame& frame);
  /// Removes the next item and returns its bytes; null if the queue is empty. Control messages are
  /// first, then the description, frames, and the picture, or its next part. Requires countSent()
  /// of the bytes that leave.
  [[nodiscard]] SharedBytes pop(LocalTime now);
  /// Counts `bytes` of payload that leave for the viewer at `now`, also those that no queue had.
  void countSent(std::size_t bytes, LocalTime now) {
    if (pacer_) pacer_->onSent(bytes, now);
  }
  /// Processes the viewer's receipt of what has arrived. Requires sendsPicturesInParts().
  void onReceipt(const Receipt& receipt, LocalTime now) { pacer_->onReceipt(receipt, now); }

  [[nodiscard]] const SendCounts& counts() const { return counts_; }

 private:
  void dropOldest(std::uint64_t& cause);
  /// Counts a picture that was sent (1) or dropped (0).
  void countPicture(double sent);
  [[nodiscard]] SharedBytes popPart(LocalTime now);

  // The members that pass() uses are first, so that they share a cache line.
  SendCounts counts_;
  bool needs_key_frame_ = true;  // after joining or a dropped frame
  std::deque<SharedBytes> control_;
  SharedBytes description_;
  std::deque<EncodedFrame> frames_;
  std::optional<EncodedVideo> video_;
  std::optional<PicturePacer> pacer_;  // nullopt: pictures leave whole
  SharedBytes picture_;                // that leaves in parts
  std::size_t picture_sent_bytes_ = 0;
  double sent_share_ = 1.0;  // of the last pictures
};

}  // namespace hapticast::server
