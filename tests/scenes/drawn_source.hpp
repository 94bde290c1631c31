// SPDX-License-Identifier: MIT
// Sources that draw each frame when it is read. Thread: one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server::test {

/// Plays info_.frame_count drawn frames, as often as it is rewound.
class DrawnSource : public RgbdSource {
 public:
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  std::optional<RgbdFrame> read() override {
    if (next_ >= *info_.frame_count) return std::nullopt;
    RgbdFrame frame = draw(next_);
    frame.index = next_++;
    frame.epoch = epoch_;
    frame.clip_time_s = double(frame.index) / info_.fps;
    return frame;
  }
  bool skip() override { return next_ < *info_.frame_count && ++next_ > 0; }
  void rewind() override {
    next_ = 0;
    ++epoch_;
  }

 protected:
  /// Returns colour, depth and, where one is given, mask of frame `index`.
  virtual RgbdFrame draw(std::uint64_t index) = 0;
  SourceInfo info_;  ///< with a frame count

 private:
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
};

/// Plays what a function draws.
class FunctionSource final : public DrawnSource {
 public:
  FunctionSource(SourceInfo info, std::uint64_t frames,
                 std::function<RgbdFrame(std::uint64_t)> make)
      : make_(std::move(make)) {
    info_ = std::move(info);
    info_.frame_count = frames;
  }

 private:
  RgbdFrame draw(std::uint64_t index) override { return make_(index); }
  std::function<RgbdFrame(std::uint64_t)> make_;
};

}  // namespace hapticast::server::test
