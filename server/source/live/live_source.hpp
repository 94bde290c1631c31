// SPDX-License-Identifier: MIT
// Live source from a device that may go away and come back: a camera or a network stream. A thread
// reads the device and keeps the newest frame only, so a slow reader never builds up a delay. After
// a loss it opens the device again each second. Thread: one, beside the thread that it owns.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Without a frame for so long there is a gap in the stream.
inline constexpr Duration kGap = std::chrono::seconds(1);

/// Colour and depth of one moment.
struct LiveFrame {
  cv::Mat color;       ///< CV_8UC3, BGR
  cv::Mat depth;       ///< CV_32FC1, same size
  LocalTime captured;  ///< when the frame was captured, at most now
};

/// An open device that delivers frames, which belong to the caller. Thread: one.
class LiveDevice {
 public:
  virtual ~LiveDevice() = default;
  /// Returns the name, the size of the frames, the rate, the kind of depth and the camera model.
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Returns what the user must know about this device, one line each.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
  /// Waits for the next frame and returns it. Returns nullopt if none came for a while. Throws
  /// SourceError if the device is gone.
  virtual std::optional<LiveFrame> read() = 0;
};

/// What an open device may ask and report while it waits.
struct LiveWatch {
  std::function<bool()> must_stop;  ///< whether a wait must end
  /// Logs that frames are missing, once in a gap. The line describes why.
  std::function<void(const std::string& line)> begin_gap;
};

/// Source whose frames are those of a live device.
class LiveSource final : public RgbdSource {
 public:
  /// Opens the device and waits until it delivers. Throws SourceError.
  using Open = std::function<std::unique_ptr<LiveDevice>(const LiveWatch& watch)>;

  /// Opens the device and logs its warnings. Throws SourceError.
  explicit LiveSource(Open open);
  /// Ends the thread, also while it waits for the device.
  ~LiveSource() override;
  LiveSource(const LiveSource&) = delete;
  LiveSource& operator=(const LiveSource&) = delete;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the newest frame that was not read yet. Returns nullopt if none arrives within 50 ms.
  /// After a gap the epoch is incremented, and clip_time_s begins at 0. Throws SourceError if the
  /// device came back with frames of another size or another kind of depth.
  std::optional<RgbdFrame> read() override;
  /// Reads a frame. Returns true, because a live source has no end.
  bool skip() override;
  /// Always throws SourceError, because a live source cannot be rewound.
  void rewind() override;

 private:
  /// A frame with its time of capture.
  struct Captured {
    RgbdFrame frame;
    LocalTime at;
  };

  /// The thread: delivers frames and opens the device again.
  void run(const std::stop_token& stop);
  /// Delivers the frames of `device_` until it is gone.
  void play(const std::stop_token& stop);
  /// Hands a frame over to read().
  void deliver(LiveFrame live);
  /// Opens the device again, with pauses. Returns false if the thread must end.
  bool reopen(const std::stop_token& stop);
  /// Logs the begin of a gap, once.
  void beginGap(const std::string& line);
  /// Ends read() with an error.
  void fail(const std::string& problem);

  const Open open_;
  const SteadyClock clock_;
  SourceInfo info_;

  // Of the thread, and of the constructor before it.
  LiveWatch watch_;
  std::unique_ptr<LiveDevice> device_;
  LocalTime last_frame_{};  // when the last frame came
  bool in_gap_ = false;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  LocalTime last_captured_{};
  LocalTime epoch_begin_{};  // capture of the epoch's first frame

  std::mutex mutex_;  // protects the members below
  std::condition_variable_any changed_;
  std::optional<Captured> newest_;
  std::string failure_;  // not empty: read() throws it

  std::stop_source stop_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::server
