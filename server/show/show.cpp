// SPDX-License-Identifier: MIT
#include "server/show/show.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <thread>
#include <utility>

#include "common/cli/run_program.hpp"

namespace hapticast::server {

Show::Show(const Settings& settings, const Clock& clock, ReadSettings reread, Producer& producer)
    : settings_(settings),
      producer_(producer),
      reloader_(settings, std::move(reread), clock),
      requests_(clock),
      counter_(clock) {
  if (const MediaClock* const media_clock = producer.mediaClock())
    sinks_.emplace(settings, clock, *media_clock, producer.description());
}

bool Show::run() {
  struct End {  // also after an exception
    Show& show;
    ~End() {
      if (show.sinks_) show.sinks_->service().end();
      show.producer_.release();
    }
  } const at_end{*this};
  producer_.connect(*this);
  listen();
  producer_.prepare();
  if (!stopped()) play();
  return producer_.finish();
}

void Show::listen() {
  if (!sinks_) {
    signalled_ = &stopAtSignals(SecondSignal::kEndsProgram);
    return;
  }
  if (producer_.operated() != nullptr)
    sinks_->service().broadcaster().onControl(
        [this](const Control& control, std::function<void()> confirm) {
          requests_.push(control, std::move(confirm));
        });
  StreamService& service = sinks_->service();
  service.watch([this](Metrics& metrics) {
    metrics.pipeline = counter_.counts();
    metrics.relay = sinks_->relayCounts();
    producer_.addTo(metrics);
  });
  service.start([this] { stop(); },
                [this] {
                  if (auto vision = reloader_.reload()) requests_.pushReload(std::move(*vision));
                });
}

void Show::play() {
  if (sinks_) {
    sinks_->service().open(producer_.description().name);
    if (settings_.wait_for_viewer) waitForViewer();
  }
  streaming_ = true;
  counter_.enter(PipelinePhase::kStream);
  producer_.start();
  while (!stopped() && (operate() || producer_.step())) {
  }
}

void Show::waitForViewer() {
  const Broadcaster& broadcaster = sinks_->service().broadcaster();
  if (broadcaster.viewers() > 0) return;
  counter_.enter(PipelinePhase::kWaitForViewer);
  spdlog::info("waiting for the first viewer");
  while (!stopped() && broadcaster.viewers() == 0)
    waitUntil(producer_.mediaClock()->now() + kSlice);
}

bool Show::operate() {
  if (sinks_) sinks_->service().manager().reportAlive();
  OperatedStream* const stream = producer_.operated();
  if (stream == nullptr) return false;
  requests_.carryOut(*stream, counter_);
  if (!requests_.paused()) return false;
  stream->idle();
  return true;
}

bool Show::waitUntil(MediaTime due, Until until) {
  while (!stopped()) {
    sinks_->service().manager().reportAlive();
    const Duration left = due - producer_.mediaClock()->now();
    if (left <= Duration::zero()) return true;
    if (until == Until::kDueOrRequest && requests_.waits()) return false;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
  return false;
}

}  // namespace hapticast::server
