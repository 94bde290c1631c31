// SPDX-License-Identifier: MIT
#include "server/show/play_on_demand.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <thread>
#include <utility>

#include "server/pipeline/pipeline_counter.hpp"
#include "server/recording/viewer_timeline.hpp"
#include "server/show/origin.hpp"
#include "server/show/play_recording.hpp"

namespace hapticast::server {

namespace {

/// Ends the service at the end of its scope, also after an exception.
struct EndOfService {
  StreamService& service;
  ~EndOfService() { service.end(); }
};

}  // namespace

void playOnDemand(const Settings& settings, const Clock& clock, ReadSettings reread) {
  Reloader reloader(settings, std::move(reread), clock);
  const RecordingPlayer player(openRecording(settings.source), false);
  PipelineCounter counter(clock);
  counter.enter(PipelinePhase::kOnDemand);
  const LocalMediaClock media_clock(clock, player.reader().begin());
  std::atomic<bool> stop{false};
  Origin origin(settings, clock, media_clock, describeBegin(player, settings.name));
  StreamService& service = origin.service();
  ViewerTimelines timelines({service.io(), media_clock, origin.signer(), settings.name},
                            player.reader(), settings.loop);
  const EndOfService end{service};  // before the time lines
  service.broadcaster().serveEach(timelines);
  origin.start([&stop] { stop = true; }, [&reloader] { (void)reloader.reload(); }, nullptr,
               [&counter](Metrics& metrics) { metrics.pipeline = counter.counts(); });
  service.open(service.broadcaster().description().name);
  spdlog::info("{} on demand: {:.1f} s, each viewer has a time line of its own", settings.source,
               toSeconds(player.reader().length()));
  while (!stop) {
    service.manager().reportAlive();
    std::this_thread::sleep_for(kSlice);
  }
}

}  // namespace hapticast::server
