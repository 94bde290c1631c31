// SPDX-License-Identifier: MIT
// Live source from one network stream with colour and depth. A thread decodes the stream and keeps
// the newest frame only, so a slow reader never builds up a delay. It connects again after the end,
// an error or silence of the stream. Thread: one, beside the thread that it owns.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/time.hpp"
#include "server/source/live/capture_clock.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/video/video_clip.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Source whose frames are those of a stream.
class LiveVideo final : public RgbdSource {
 public:
  /// Connects to `url` and decodes the first frame. `fps` > 0 states the rate of the stream,
  /// frames/s. Throws SourceError. No message has a password of `url`.
  LiveVideo(std::string url, const VideoLayout& layout, double fps);
  /// Ends the thread, also while it waits for the network.
  ~LiveVideo() override;
  LiveVideo(const LiveVideo&) = delete;
  LiveVideo& operator=(const LiveVideo&) = delete;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the newest frame that was not read yet. Returns nullopt if none arrives within 50 ms.
  /// After a gap of more than a second the epoch is incremented, and clip_time_s begins at 0.
  /// Throws SourceError if the stream came back with pictures of another size or another kind of
  /// depth.
  std::optional<RgbdFrame> read() override;
  /// Reads a frame. Returns true, because a stream has no end.
  bool skip() override;
  /// Always throws SourceError, because a live source cannot be rewound.
  void rewind() override;

 private:
  /// A frame with its time of capture.
  struct Captured {
    RgbdFrame frame;
    LocalTime at;
  };

  /// Opens the stream as `video_`. Throws SourceError.
  void connect();
  /// The thread: delivers frames and connects again.
  void run();
  /// Delivers the frames of `video_` until it ends.
  void play();
  /// Returns the next frame of `video_`; nullopt at its end, and if it can deliver no frame.
  std::optional<RgbdFrame> readFrame();
  /// Hands a frame over to read().
  void deliver(RgbdFrame frame, LocalTime captured);
  /// Connects again with pauses, until that succeeds or the thread must end. Returns false if it
  /// must end.
  bool reconnect();
  /// Waits for `pause`. Returns false if the thread must end.
  bool wait(Duration pause);
  /// Logs the begin of a gap, once. `cause` is the rest of the line.
  void beginGap(const char* cause);
  /// Returns whether a wait for the network must end. Called by the libraries while they wait.
  bool mustGiveUp();
  /// Ends read() with an error.
  void fail(const std::string& problem);

  const std::string url_;
  const std::string shown_;  // the address without secrets
  const VideoLayout layout_;
  const double fps_;
  const SteadyClock clock_;
  SourceInfo info_;

  // Of the thread, and of the constructor before it.
  std::unique_ptr<VideoClip> video_;
  LocalTime deadline_{};    // when a wait for the network ends
  LocalTime last_frame_{};  // when the last frame came
  bool in_gap_ = false;
  bool playing_ = false;  // whether silence begins a gap
  CaptureClock capture_clock_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  LocalTime epoch_begin_{};  // capture of the epoch's first frame

  std::atomic<bool> stop_{false};
  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::optional<Captured> newest_;
  std::string failure_;  // not empty: read() throws it

  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::server
