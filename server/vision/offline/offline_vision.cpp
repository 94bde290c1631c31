// SPDX-License-Identifier: MIT
#include "server/vision/offline/offline_vision.hpp"

#include <utility>

#include "server/vision/tracker.hpp"

namespace hapticast::server {

namespace {

VisionSettings prepare(VisionSettings settings) {
  settings.offline = true;
  for (const Stage stage : {Stage::kSegment, Stage::kClean, Stage::kSmooth, Stage::kMotion}) {
    std::optional<bool>& forced = settings.plan.forced[static_cast<std::size_t>(stage)];
    if (!forced) forced = true;
  }
  return settings;
}

}  // namespace

OfflineVision::OfflineVision(RgbdSource& source, const SourceInfo& info,
                             const VisionSettings& settings)
    : source_(source), vision_(info, prepare(settings)), camera_(selectCamera(info, settings)) {}

bool OfflineVision::scan(const Vision::Progress& progress) {
  return vision_.scan(source_, progress);
}

std::optional<VisionResult> OfflineVision::next(bool wanted) {
  if (!fusion_) {
    const DepthRange range = vision_.mapped() ? vision_.mapped()->range : DepthRange{0.0, 1.0};
    fusion_.emplace(FusionView{vision_.description().workspace, range, camera_});
  }
  while (true) {
    if (auto result = fusion_->next(ended_, wanted)) return result;
    if (ended_) return std::nullopt;
    const std::optional<RgbdFrame> frame = source_.read();
    if (!frame) {
      ended_ = true;
      for (VisionResult& result : vision_.flush()) fusion_->push(std::move(result));
      continue;
    }
    const MediaTime time = mediaTime(static_cast<double>(frame->index) / source_.info().fps);
    if (auto result = vision_.push(*frame, time)) fusion_->push(std::move(*result));
  }
}

}  // namespace hapticast::server
