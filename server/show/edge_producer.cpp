// SPDX-License-Identifier: MIT
#include "server/show/producers.hpp"

#include <spdlog/spdlog.h>

#include <optional>

#include "server/relay/relay_clock.hpp"
#include "server/relay/relay_subscriber.hpp"
#include "server/show/show.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

class EdgeProducer final : public Producer {
 public:
  EdgeProducer(const Settings& settings, const Clock& clock);

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override;
  void connect(Show& show) override;
  void prepare() override;
  void start() override;
  bool step() override;
  void release() noexcept override { subscriber_.reset(); }
  void addTo(Metrics& metrics) const override;

 private:
  const Settings& settings_;
  const Clock& clock_;
  NatsAddress address_;
  RelayClock media_clock_;
  std::optional<RelaySubscriber> subscriber_;
};

NatsAddress requireNatsAddress(const std::string& text) {
  if (const auto address = parseNatsAddress(text)) return *address;
  throw SourceError(hideCredentials(text) + ": is not " + kNatsForm);
}

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
  Producer::connect(show);
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
  return true;
}

void EdgeProducer::addTo(Metrics& metrics) const {
  metrics.pipeline.reset();
  metrics.relay = subscriber_->counts();
}

}  // namespace

std::unique_ptr<Producer> makeEdgeProducer(const Settings& settings, const Clock& clock) {
  return std::make_unique<EdgeProducer>(settings, clock);
}

}  // namespace hapticast::server
