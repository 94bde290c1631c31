// SPDX-License-Identifier: MIT
// Changes to a running stream that wait for the pipeline. Operators pause, seek and set the
// material (ControlQueue). A reload of the settings changes materials too. The network thread adds
// the changes, and the pipeline's thread applies them between two frames. Thread: see each
// function.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "common/protocol/messages.hpp"
#include "server/pipeline/control_queue.hpp"
#include "server/pipeline/frame_pump.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/stream/limited_log.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Requests that wait for the pipeline.
class OperatorRequests {
 public:
  /// Time in which newer seeks end a running one, from the begin of the first. The seek that runs
  /// then comes to its end. So an operator who seeks on and on cannot stop the stream; chosen.
  static constexpr Duration kNewerSeeks = std::chrono::seconds(1);

  /// `clock` must outlive this object.
  explicit OperatorRequests(const Clock& clock) : clock_(clock), log_(clock) {}

  /// Adds a request of an operator. carryOut() calls `confirm` once the request is carried out, or
  /// newer values have replaced all of its own. Thread: any.
  void push(const Control& request, std::function<void()> confirm) {
    queue_.push(request, std::move(confirm));
  }
  /// Stores the settings that a reload has read. The next carryOut() applies their materials and
  /// masses only. Thread: any.
  void pushReload(VisionSettings reloaded);
  /// Carries out the requests and the reload that were added since the last call. A newer seek ends
  /// a running one. Writes the new materials to `settings`, the settings of the stream. Returns
  /// true if it carried out a request of an operator; a reload alone does not count. Throws
  /// SourceError if the source fails during a seek. Thread: the pipeline's.
  bool carryOut(FramePump& pump, PipelineCounter& counter, VisionSettings& settings);
  /// Returns whether the stream is paused. Thread: the pipeline's.
  [[nodiscard]] bool paused() const { return paused_; }

 private:
  void applyReload(FramePump& pump, VisionSettings& settings);
  void carryOut(const Control& request, FramePump& pump, PipelineCounter& counter,
                VisionSettings& settings);
  void seek(double time_s, FramePump& pump, PipelineCounter& counter);

  const Clock& clock_;
  ControlQueue queue_;
  std::mutex mutex_;
  std::optional<VisionSettings> reloaded_;  // guarded by mutex_
  bool paused_ = false;
  LimitedLog log_;
};

}  // namespace hapticast::server
