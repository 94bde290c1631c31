// SPDX-License-Identifier: MIT
#include "server/pipeline/operator_requests.hpp"

#include <fmt/core.h>

#include <utility>

namespace hapticast::server {

void OperatorRequests::pushReload(VisionSettings reloaded) {
  const std::lock_guard lock(mutex_);
  reloaded_ = std::move(reloaded);
}

void OperatorRequests::applyReload(OperatedStream& stream) {
  std::optional<VisionSettings> reloaded;
  {
    const std::lock_guard lock(mutex_);
    reloaded.swap(reloaded_);
  }
  if (reloaded) stream.applyReload(*reloaded);
}

void OperatorRequests::carryOut(OperatedStream& stream, PipelineCounter& counter) {
  applyReload(stream);
  const auto merged = queue_.take();
  if (!merged) return;
  carryOut(merged->request, stream, counter);
  merged->confirmAll();
}

void OperatorRequests::carryOut(const Control& request, OperatedStream& stream,
                                PipelineCounter& counter) {
  if (request.paused && *request.paused != paused_) {
    paused_ = *request.paused;
    log_.info(fmt::format("an operator {} the stream", paused_ ? "pauses" : "continues"));
    stream.setPaused(paused_);
  }
  if (request.seek_s) seek(*request.seek_s, stream, counter);
  counter.enter(paused_ ? PipelinePhase::kPause : PipelinePhase::kStream);
  if (request.speed)
    log_.info(stream.setSpeed(*request.speed)
                  ? fmt::format("an operator sets the speed to {:g}", *request.speed)
                  : "an operator sets the speed, but only a recording has another one");
  if (request.material == Material{}) return;
  stream.changeMaterials(request.material);
  log_.info("an operator changes the material");
}

void OperatorRequests::seek(double time_s, OperatedStream& stream, PipelineCounter& counter) {
  if (!stream.canSeek())
    return log_.info("an operator seeks, but a live source has no other times");
  counter.enter(PipelinePhase::kSeek);
  const LocalTime begin = clock_.now();
  for (std::optional<double> next_s = time_s; next_s;) {
    log_.info(fmt::format("an operator seeks to {:g} s", *next_s));
    stream.seek(*next_s, [&] { return clock_.now() - begin < kNewerSeeks && queue_.seekWaits(); });
    if (clock_.now() - begin >= kNewerSeeks) return;
    next_s = queue_.takeSeek();
  }
}

}  // namespace hapticast::server
