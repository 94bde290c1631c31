// SPDX-License-Identifier: MIT
// Vision of a recorded clip without a limit of time (bake): scans the whole clip, keeps the stages
// on that a scene plan leaves out for speed, and averages the reliefs over the frames before and
// after each frame (ReliefFusion). The media time of a frame is its time in the clip. Thread: one.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "server/source/rgbd_source.hpp"
#include "server/vision/offline/relief_fusion.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// The frames of one clip.
class OfflineVision {
 public:
  /// `source` must outlive this object and must not be live. `info`: that of the source, with the
  /// name of the stream. Throws SourceError as Vision does.
  OfflineVision(RgbdSource& source, const SourceInfo& info, const VisionSettings& settings);

  /// Scans the clip as Vision::scan() does. Call it first.
  bool scan(const Vision::Progress& progress);
  /// Returns the next frame; nullopt at the end. `wanted`: false leaves out the averages, for
  /// frames that are done. Throws SourceError.
  [[nodiscard]] std::optional<VisionResult> next(bool wanted = true);
  /// Makes the reliefs of the next frame independent of those returned before.
  void beginBlock() {
    if (fusion_) fusion_->beginBlock();
  }

  [[nodiscard]] const Vision& vision() const { return vision_; }

 private:
  RgbdSource& source_;
  Vision vision_;
  CameraModel camera_;
  std::optional<ReliefFusion> fusion_;  // from the first frame on
  bool ended_ = false;
};

}  // namespace hapticast::server
