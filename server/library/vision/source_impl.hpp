// SPDX-License-Identifier: MIT
// State of a Source, which Vision reads too. Thread: at most one at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "server/include/hapticast/vision.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast {

class Source::Impl {
 public:
  /// Opens `spec`. Throws SourceError.
  Impl(const std::string& spec, double fps);

  [[nodiscard]] const SourceInfo& info() const { return info_; }
  [[nodiscard]] std::optional<Images> read();
  void rewind();
  /// Returns whether read() has returned images since the clip began.
  [[nodiscard]] bool hasBegun() const { return has_begun_; }
  /// Returns the source of the server. Who reads it rewinds it.
  [[nodiscard]] server::RgbdSource& inner() { return *source_; }

 private:
  /// Returns the time of `frame`, which is later than that of the frame before.
  [[nodiscard]] double findTime_s(const server::RgbdFrame& frame);

  SteadyClock clock_;
  LocalTime opened_ = clock_.now();
  std::unique_ptr<server::RgbdSource> source_;
  SourceInfo info_;
  LocalTime last_captured_ = opened_;  // of a live source
  double begin_s_ = 0.0;               // of this playback of a clip
  double last_s_ = 0.0;
  bool has_begun_ = false;
};

}  // namespace hapticast
