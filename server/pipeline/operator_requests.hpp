// SPDX-License-Identifier: MIT
// Queue of changes to a running stream. Operators pause, seek and set the material. A reload of the
// settings changes materials too. The network thread adds the changes, and the pipeline's thread
// applies them between two frames. Thread: see each function.
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "common/protocol/messages.hpp"
#include "server/pipeline/frame_pump.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Requests that wait for the pipeline.
class OperatorRequests {
 public:
  /// Adds a request of an operator. Drops it if 100 requests wait. Thread: any.
  void push(const Control& request);
  /// Stores the settings that a reload has read. The next carryOut() applies their materials and
  /// masses only. Thread: any.
  void pushReload(VisionSettings reloaded);
  /// Carries out the requests and the reload that were added since the last call. Writes the new
  /// materials to `settings`, the settings of the stream. Returns true if it carried out a request
  /// of an operator; a reload alone does not count. Throws SourceError if the source fails during a
  /// seek. Thread: the pipeline's.
  bool carryOut(FramePump& pump, PipelineCounter& counter, VisionSettings& settings);
  /// Returns whether the stream is paused. Thread: the pipeline's.
  [[nodiscard]] bool paused() const { return paused_; }

 private:
  void carryOut(const Control& request, FramePump& pump, PipelineCounter& counter,
                VisionSettings& settings);

  std::mutex mutex_;
  std::vector<Control> requests_;           // guarded by mutex_
  std::optional<VisionSettings> reloaded_;  // guarded by mutex_
  bool paused_ = false;
};

}  // namespace hapticast::server
