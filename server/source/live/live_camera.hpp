// SPDX-License-Identifier: MIT
// Live source from a camera that may go away and come back. An unplugged camera gives one warning,
// and the source tries to open it again each second. Thread: one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/skipped_frames.hpp"

namespace hapticast::server {

/// One picture of a live device.
struct LivePicture {
  bool is_depth = false;
  LocalTime time{};     ///< when the picture was captured or arrived
  cv::Mat image;        ///< colour: CV_8UC3, BGR; depth: CV_32FC1; empty if there is a problem
  std::string problem;  ///< why the picture is unusable, with the name of the device; else empty
};

/// An open device that delivers pictures of colour and of depth. Its pictures belong to the caller.
/// Thread: one.
class LiveDevice {
 public:
  virtual ~LiveDevice() = default;
  /// Returns the name, the size of the colour, the rate, the kind of depth and the camera model.
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Returns what the user must know about this device, one line each.
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
  /// Waits for the next picture, at most `longest`, and returns it. Returns nullopt if none came.
  /// Leaves out pictures that are older than another one of the same kind. Throws SourceError if
  /// the device is gone.
  virtual std::optional<LivePicture> read(Duration longest) = 0;
};

/// Colour and depth of one moment.
struct LivePair {
  cv::Mat color;
  cv::Mat depth;
  LocalTime time{};  ///< that of the colour
};

/// Pairs pictures of colour with pictures of depth by their times. Thread: one.
class PicturePairer {
 public:
  /// `fps`: frames/s of the colour; a pair is at most half a frame apart.
  explicit PicturePairer(double fps);

  /// Adds a picture. Returns it with the last one of the other kind if both are of one moment. No
  /// picture is in two pairs.
  std::optional<LivePair> push(LivePicture picture);

 private:
  Duration longest_apart_;
  std::optional<LivePicture> color_;
  std::optional<LivePicture> depth_;
};

/// Source whose frames are those of a live device.
class LiveCamera final : public RgbdSource {
 public:
  /// Opens the device. Throws SourceError.
  using Open = std::function<std::unique_ptr<LiveDevice>()>;

  /// Opens the device, logs its warnings and waits for its first frame, at most 5 s. Throws
  /// SourceError, also if there is no frame.
  explicit LiveCamera(Open open);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Waits up to 50 ms for the next frame and returns it. Returns nullopt if none came. Without a
  /// frame for a second it tries to open the device again each second. The first frame after that
  /// begins a new epoch. Smaller depth of the same aspect ratio is scaled to the size of the
  /// colour.
  std::optional<RgbdFrame> read() override;
  bool skip() override { return read().has_value(); }
  /// Always throws SourceError, because a live source cannot be rewound.
  void rewind() override;

 private:
  void open();
  /// Returns the next pair, or nullopt if none came in 50 ms. Throws SourceError after the
  /// deadline.
  [[nodiscard]] std::optional<LivePair> readPair();
  [[noreturn]] void throwNoPair() const;
  [[nodiscard]] RgbdFrame makeFrame(LivePair pair);
  void lose(const std::string& reason);

  Open open_;
  std::unique_ptr<LiveDevice> device_;
  SourceInfo info_;
  std::optional<PicturePairer> pairer_;
  LocalTime deadline_{};    // of the next pair
  LocalTime next_try_{};    // to open the device
  bool any_color_ = false;  // since the last pair
  bool any_depth_ = false;
  std::string problem_;  // of a picture since the last pair
  bool away_ = false;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  LocalTime began_{};  // of the epoch
  SkippedFrames skipped_{true};
  bool logged_scaling_ = false;
};

}  // namespace hapticast::server
