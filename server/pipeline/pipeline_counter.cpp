// SPDX-License-Identifier: MIT
#include "server/pipeline/pipeline_counter.hpp"

#include <utility>

#include "common/haptic_frame.hpp"

namespace hapticast::server {

PipelineCounter::PipelineCounter(const Clock& clock) : clock_(clock) {
  counts_.phase_since = clock.now();
}

void PipelineCounter::enter(PipelinePhase phase) {
  const std::lock_guard lock(mutex_);
  counts_.phase = phase;
  counts_.phase_since = clock_.now();
}

void PipelineCounter::addFrame(Duration vision,
                               const std::map<std::uint32_t, std::vector<PlanLine>>& plans) {
  std::vector<std::array<bool, kStages>> plan;
  const std::lock_guard lock(mutex_);
  counts_.vision.add(vision);
  for (const auto& [id, lines] : plans) {
    if (plan.size() == kMaxObjects) break;
    auto& on = plan.emplace_back();
    for (const PlanLine& line : lines) {
      const auto stage = static_cast<std::size_t>(line.stage);
      on[stage] = line.on;
      if (line.on && line.saves_ms > 0.0)
        counts_.stages[stage].add(fromSeconds(1e-3 * line.saves_ms));
    }
  }
  counts_.plan = std::move(plan);
}

void PipelineCounter::set(std::uint64_t skipped, const EncoderTimes& encoder,
                          const StageTime& sign) {
  const std::lock_guard lock(mutex_);
  counts_.skipped = skipped;
  counts_.encoder = encoder;
  counts_.sign = sign;
}

PipelineCounts PipelineCounter::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace hapticast::server
