// SPDX-License-Identifier: MIT
// The producer of a clip or a live source: source and vision run on the thread of the show, the
// encoding on a second one (EncoderThread).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/frame_pump.hpp"
#include "server/pipeline/plan_log.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// Produces the frames of the source of `settings` until the clip ends (with --loop it repeats), or
/// until the number of frames in --frames is reached.
class ClipProducer final : public Producer {
 public:
  /// Opens the source. `settings` and `clock` must outlive this object. Throws SourceError.
  ClipProducer(const Settings& settings, const Clock& clock);

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override { return vision_.description(); }
  void connect(Show& show) override;
  [[nodiscard]] OperatedStream* operated() override { return pump_ ? &*pump_ : nullptr; }
  void prepare() override;
  void start() override;
  bool step() override;
  bool finish() override;
  void release() noexcept override;

 private:
  void onFrame();

  const Settings& settings_;
  const Clock& clock_;
  LocalMediaClock media_clock_;
  Show* show_ = nullptr;                 // while connected
  std::function<void()> while_waiting_;  // what goes on while the source waits for a child
  std::unique_ptr<RgbdSource> source_;
  VisionSettings vision_settings_;
  Vision vision_;
  PlanLog plan_log_;
  DepthRangeLog range_log_;
  std::optional<EncoderThread> encoder_;
  std::optional<FramePump> pump_;
  std::uint64_t frames_ = 0;
};

}  // namespace hapticast::server
