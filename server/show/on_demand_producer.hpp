// SPDX-License-Identifier: MIT
// The producer of a recording on demand (--source FILE.mcap --on-demand): each viewer has a time
// line of its own (ViewerTimeline), which runs in the network thread.
#pragma once

#include <optional>

#include "common/playback/recording_player.hpp"
#include "server/recording/viewer_timeline.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"

namespace hapticast::server {

/// Serves the recording `settings.source` until the show stops. With --loop each time line repeats.
class OnDemandProducer final : public Producer {
 public:
  /// `settings` and `clock` must outlive this object. Throws RecordingError.
  OnDemandProducer(const Settings& settings, const Clock& clock);

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override;
  void connect(Show& show) override;
  void start() override;
  bool step() override;
  void release() noexcept override { timelines_.reset(); }

 private:
  const Settings& settings_;
  const RecordingPlayer player_;  // for the description of its begin
  LocalMediaClock media_clock_;
  Show* show_ = nullptr;
  std::optional<ViewerTimelines> timelines_;
};

}  // namespace hapticast::server
