// SPDX-License-Identifier: MIT
#include "server/edge.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <utility>

#include "server/relay/relay_clock.hpp"
#include "server/relay/relay_subscriber.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/stream_service.hpp"

namespace hapticast::server {

namespace {

NatsAddress requireNatsAddress(const std::string& text) {
  if (const auto address = parseNatsAddress(text)) return *address;
  throw SourceError(text + ": is not " + kNatsForm);
}

}  // namespace

void runEdge(const Settings& settings, const Clock& clock, ReadSettings reread) {
  const NatsAddress address = requireNatsAddress(settings.source);
  RelayClock media_clock(clock);
  std::atomic<bool> stop{false};
  Reloader reloader(settings, std::move(reread));
  // The first origin determines description and identity, before the first viewer.
  StreamService service(settings, clock, media_clock, {}, {});
  RelaySubscriber subscriber(address, settings.nats, settings.origin_keys, clock, media_clock,
                             service.broadcaster());
  service.start([&stop] { stop = true; }, [&reloader] { (void)reloader.reload(); });
  service.manager().reportReady("waiting for an origin of the channel " + address.channel);
  spdlog::info("edge of the channel {}: waiting for an origin", address.channel);
  bool open = false;
  while (!stop) {
    subscriber.poll();
    service.manager().reportAlive();
    if (!open && subscriber.description()) {
      const StreamDescription description = *subscriber.description();
      service.open(description.name);
      spdlog::info("streaming {} ({} x {}, {:g} frames/s)", settings.source,
                   description.workspace.width_px, description.workspace.height_px,
                   description.fps);
      open = true;
    }
  }
}

}  // namespace hapticast::server
