// SPDX-License-Identifier: MIT
// Interface of a stream that operators change: a clip, or a recording. Thread: the stream's.
#pragma once

#include <functional>

#include "common/protocol/messages.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// A stream that operators pause, seek and change.
class OperatedStream {
 public:
  virtual ~OperatedStream() = default;

  /// Receives the begin (true) or the end of a pause.
  virtual void setPaused(bool paused) = 0;
  /// Call it while the stream is paused: waits for a short time.
  virtual void idle() = 0;
  /// Returns whether the stream has other times, so that seek() may be called.
  [[nodiscard]] virtual bool canSeek() const { return true; }
  /// Continues at `time_s` of the clip. Ends early as soon as `ends_early` returns true. Throws
  /// SourceError.
  virtual void seek(double time_s, const std::function<bool()>& ends_early) = 0;
  /// Sets the speed, 1: as recorded. Returns false if the stream has one speed only.
  virtual bool setSpeed(double speed) = 0;
  /// Replaces the values of the material of all objects by those that `change` has.
  virtual void changeMaterials(const Material& change) = 0;
  /// Replaces materials and masses by those of the configuration that was read again.
  virtual void applyReload(const VisionSettings& /*reloaded*/) {}
};

}  // namespace hapticast::server
