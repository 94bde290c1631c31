// SPDX-License-Identifier: MIT
// Collects the statistics of the pipeline (PipelineCounts). Other threads read copies. Thread: any.
#pragma once

#include <map>
#include <mutex>
#include <vector>

#include "server/pipeline/pipeline_counts.hpp"
#include "server/vision/scene_plan.hpp"

namespace hapticast::server {

/// Statistics of one pipeline.
class PipelineCounter {
 public:
  /// Begins in the phase kScan. `clock` must outlive this object.
  explicit PipelineCounter(const Clock& clock);

  /// Begins the phase `phase`.
  void enter(PipelinePhase phase);
  /// Adds a frame. `vision`: time that vision needed for it. `plans`: scene plans of its objects,
  /// by id. The first kMaxObjects count.
  void addFrame(Duration vision, const std::map<std::uint32_t, std::vector<PlanLine>>& plans);
  /// Sets the totals that other objects count: skipped frames, times of the encoder, times of
  /// signatures.
  void set(std::uint64_t skipped, const EncoderTimes& encoder, const StageTime& sign);
  [[nodiscard]] PipelineCounts counts() const;

 private:
  const Clock& clock_;
  mutable std::mutex mutex_;
  PipelineCounts counts_;  // guarded by mutex_
};

}  // namespace hapticast::server
