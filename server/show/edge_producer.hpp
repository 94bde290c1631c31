// SPDX-License-Identifier: MIT
// The producer of an edge: it receives the stream of a channel's origin from NATS, without vision,
// encoder and signer of its own (RelaySubscriber). The show opens when the first origin is known.
#pragma once

#include <mutex>
#include <optional>

#include "server/relay/relay_clock.hpp"
#include "server/relay/relay_subscriber.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"

namespace hapticast::server {

/// Receives the channel `settings.source` until the show stops.
class EdgeProducer final : public Producer {
 public:
  /// `settings` and `clock` must outlive this object. Throws SourceError for a wrong address.
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
  Show* show_ = nullptr;
  std::optional<RelaySubscriber> subscriber_;
  mutable std::mutex mutex_;
  RelayCounts counts_{.is_edge = true};  // guarded by mutex_; a copy, so that /metrics never waits
};

}  // namespace hapticast::server
