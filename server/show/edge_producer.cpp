// SPDX-License-Identifier: MIT
#include "server/show/edge_producer.hpp"

#include <spdlog/spdlog.h>

#include "server/show/show.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

NatsAddress requireNatsAddress(const std::string& text) {
  if (const auto address = parseNatsAddress(text)) return *address;
  throw SourceError(hideCredentials(text) + ": is not " + kNatsForm);
}

}  // namespace

EdgeProducer::EdgeProducer(const Settings& settings, const Clock& clock)
    : settings_(settings),
      clock_(clock),
      address_(requireNatsAddress(settings.source)),
      media_clock_(clock) {}

StreamDescription EdgeProducer::description() const {
  // The first origin determines description and identity, before the first viewer.
  return subscriber_ ? subscriber_->description().value_or(StreamDescription{})
                     : StreamDescription{};
}

void EdgeProducer::connect(Show& show) {
  show_ = &show;
  subscriber_.emplace(address_, settings_.nats, settings_.origin_keys, clock_, media_clock_,
                      show.sinks().service().broadcaster());
}

void EdgeProducer::prepare() {
  show_->sinks().service().manager().reportReady("waiting for an origin of the channel " +
                                                 address_.channel);
  spdlog::info("edge of the channel {}: waiting for an origin", address_.channel);
  while (!show_->stopped() && !subscriber_->description()) {
    show_->sinks().service().manager().reportAlive();
    (void)step();
  }
}

void EdgeProducer::start() {
  const StreamDescription stream = description();
  spdlog::info("streaming {} ({} x {}, {:g} frames/s)", toString(address_),
               stream.workspace.width_px, stream.workspace.height_px, stream.fps);
}

bool EdgeProducer::step() {
  subscriber_->poll();
  const RelayCounts counts = subscriber_->counts();
  const std::lock_guard lock(mutex_);
  counts_ = counts;
  return true;
}

void EdgeProducer::addTo(Metrics& metrics) const {
  const std::lock_guard lock(mutex_);
  metrics.relay = counts_;
}

}  // namespace hapticast::server
