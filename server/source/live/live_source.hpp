// SPDX-License-Identifier: MIT
// Live source from a device that may disconnect and return: a camera or a network stream. A thread
// reads the device and stores only the newest frame, so a slow reader causes no growing delay.
// After a loss the thread tries to open the device again each second. Thread: one, beside the
// thread that it owns.
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

/// Time without a frame after which the stream has a gap.
inline constexpr Duration kGap = std::chrono::seconds(1);

/// Colour and depth of one moment.
struct LiveFrame {
  cv::Mat color;       ///< CV_8UC3, BGR
  cv::Mat depth;       ///< CV_32FC1, same size
  LocalTime captured;  ///< capture time, never in the future
};

/// An open device that delivers frames. The caller owns their images. Thread: one.
class LiveDevice {
 public:
  virtual ~LiveDevice() = default;
  /// Returns the name, the size of the frames, the rate, the kind of depth and the camera model.
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Returns warnings about this device for the log, one line each.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
  /// Waits for the next frame and returns it. Returns nullopt if no frame arrived within some time.
  /// Throws SourceError if the device is lost.
  virtual std::optional<LiveFrame> read() = 0;
};

/// Callbacks of an open device while it waits.
struct LiveWatch {
  std::function<bool()> must_stop;  ///< whether a wait must end
  /// Logs that frames are missing, once in a gap. The line describes why.
  std::function<void(const std::string& line)> begin_gap;
};

/// Source whose frames are those of a live device.
class LiveSource final : public RgbdSource {
 public:
  /// Function that opens the device and waits for its first frame. Throws SourceError.
  using Open = std::function<std::unique_ptr<LiveDevice>(const LiveWatch& watch)>;

  /// Opens the device and logs its warnings. Throws SourceError.
  explicit LiveSource(Open open);
  /// Ends the thread, also while it waits for the device.
  ~LiveSource() override;
  LiveSource(const LiveSource&) = delete;
  LiveSource& operator=(const LiveSource&) = delete;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the newest frame that was not read yet. Returns nullopt if no frame arrives within 50
  /// ms, or if the frame is older than kGap. After a gap the epoch is incremented, and clip_time_s
  /// counts from the first frame after it. Throws SourceError if the device returned with frames of
  /// another size or another kind of depth, or if its thread has failed. All later calls then
  /// throw.
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
  /// Delivers the frames of `device_` until the device is lost.
  void play(const std::stop_token& stop);
  /// Hands a frame over to read().
  void deliver(LiveFrame live);
  /// Tries to open the device until that succeeds, 1 s after each try. Returns false if the thread
  /// must end: after a stop, or if the device has other frames now.
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
