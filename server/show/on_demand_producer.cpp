// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <optional>

#include "common/playback/recording_player.hpp"
#include "server/recording/viewer_timeline.hpp"
#include "server/show/producers.hpp"
#include "server/show/show.hpp"

namespace hapticast::server {

namespace {

class OnDemandProducer final : public Producer {
 public:
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
  std::optional<ViewerTimelines> timelines_;
};

OnDemandProducer::OnDemandProducer(const Settings& settings, const Clock& clock)
    : settings_(settings),
      player_(openRecording(settings.source), false),
      media_clock_(clock, player_.reader().begin()) {}

StreamDescription OnDemandProducer::description() const {
  return describeBegin(player_, settings_.name);
}

void OnDemandProducer::connect(Show& show) {
  Producer::connect(show);
  StreamService& service = show.sinks().service();
  timelines_.emplace(
      ViewerTimeline::Server{service.io(), media_clock_, show.sinks().signer(), settings_.name},
      player_.reader(), settings_.loop);
  service.broadcaster().serveEach(*timelines_);
}

void OnDemandProducer::start() {
  show_->counter().enter(PipelinePhase::kOnDemand);
  spdlog::info("{} on demand: {:.1f} s, each viewer has a time line of its own", settings_.source,
               toSeconds(player_.reader().length()));
}

bool OnDemandProducer::step() {
  (void)show_->waitUntil(media_clock_.now() + Show::kSlice);
  return true;
}

}  // namespace

std::unique_ptr<Producer> makeOnDemandProducer(const Settings& settings, const Clock& clock) {
  return std::make_unique<OnDemandProducer>(settings, clock);
}

}  // namespace hapticast::server
