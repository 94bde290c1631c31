// SPDX-License-Identifier: MIT
#include "server/show/edge.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <mutex>
#include <utility>

#include "server/relay/relay_clock.hpp"
#include "server/relay/relay_subscriber.hpp"
#include "server/show/stream_service.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

NatsAddress requireNatsAddress(const std::string& text) {
  if (const auto address = parseNatsAddress(text)) return *address;
  throw SourceError(hideCredentials(text) + ": is not " + kNatsForm);
}

}  // namespace

void runEdge(const Settings& settings, const Clock& clock, ReadSettings reread) {
  const NatsAddress address = requireNatsAddress(settings.source);
  RelayClock media_clock(clock);
  std::atomic<bool> stop{false};
  Reloader reloader(settings, std::move(reread), clock);
  std::mutex mutex;
  RelayCounts counts{.is_edge = true};  // guarded by mutex; the network thread reads it
  // The first origin determines description and identity, before the first viewer.
  StreamService service(settings, clock, media_clock, {}, {});
  RelaySubscriber subscriber(address, settings.nats, settings.origin_keys, clock, media_clock,
                             service.broadcaster());
  service.watch([&](Metrics& metrics) {
    const std::lock_guard lock(mutex);
    metrics.relay = counts;
  });
  service.start([&stop] { stop = true; }, [&reloader] { (void)reloader.reload(); });
  service.manager().reportReady("waiting for an origin of the channel " + address.channel);
  spdlog::info("edge of the channel {}: waiting for an origin", address.channel);
  bool open = false;
  while (!stop) {
    subscriber.poll();
    service.manager().reportAlive();
    {
      const std::lock_guard lock(mutex);
      counts = subscriber.counts();
    }
    if (!open && subscriber.description()) {
      const StreamDescription description = *subscriber.description();
      service.open(description.name);
      spdlog::info("streaming {} ({} x {}, {:g} frames/s)", toString(address),
                   description.workspace.width_px, description.workspace.height_px,
                   description.fps);
      open = true;
    }
  }
}

}  // namespace hapticast::server
