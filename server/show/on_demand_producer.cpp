// SPDX-License-Identifier: MIT
#include "server/show/on_demand_producer.hpp"

#include <spdlog/spdlog.h>

#include "server/show/recording_producer.hpp"
#include "server/show/show.hpp"

namespace hapticast::server {

OnDemandProducer::OnDemandProducer(const Settings& settings, const Clock& clock)
    : settings_(settings),
      player_(openRecording(settings.source), false),
      media_clock_(clock, player_.reader().begin()) {}

StreamDescription OnDemandProducer::description() const {
  return describeBegin(player_, settings_.name);
}

void OnDemandProducer::connect(Show& show) {
  show_ = &show;
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

}  // namespace hapticast::server
