// SPDX-License-Identifier: MIT
// Statistics of the pipeline from source to encoder, for operators. Thread: any.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/time.hpp"
#include "server/stream/stage_time.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Present phase of the pipeline.
enum class PipelinePhase : std::uint8_t {
  kScan,           ///< opens the source and scans the clip
  kWaitForViewer,  ///< --wait-for-viewer: no viewer has joined yet
  kStream,
  kPause,     ///< an operator has paused the stream
  kOnDemand,  ///< each viewer has a stream of its own (--on-demand)
  kSeek,      ///< an operator seeks: vision processes the frames before that time
};

/// Times of the encoder's thread.
struct EncoderTimes {
  StageTime encode;   ///< frames, with their signatures
  StageTime picture;  ///< pictures
};

/// Statistics since the server's start.
struct PipelineCounts {
  PipelinePhase phase = PipelinePhase::kScan;
  LocalTime phase_since{};
  std::uint64_t skipped = 0;                ///< frames left out because the server was late
  StageTime vision;                         ///< whole frames
  std::array<StageTime, kStages> stages{};  ///< frames of one object, while the stage is on
  EncoderTimes encoder;
  StageTime sign;
  /// Stages that are on, for each tracked object, in the order of the objects' ids; at most
  /// kMaxObjects.
  std::vector<std::array<bool, kStages>> plan;
};

}  // namespace hapticast::server
