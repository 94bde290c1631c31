// SPDX-License-Identifier: MIT
// Drives the pipeline of one stream: reads each frame of the source when it is due, passes it to
// vision with its media time, and passes completed frames to the encoder. Pacer determines when a
// frame of a clip is due. A frame of a live source is due when it arrives. Thread: the pipeline's.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/time.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/operated_stream.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/source/pacer.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// Result of a step of the pump.
enum class PumpStep : std::uint8_t {
  kFrame,    ///< a frame was processed
  kSilence,  ///< a live source has no frame at the moment
  kEnd,      ///< the clip has ended
};

/// The pump of one stream.
class FramePump final : public OperatedStream {
 public:
  /// Waits until `due` or until the server stops. Returns false if the server stops.
  using Wait = std::function<bool(MediaTime due)>;

  /// The objects that the pump connects. All of them must outlive the pump.
  struct Parts {
    RgbdSource& source;
    Vision& vision;
    VisionSettings& settings;  ///< those of vision; operators change their materials
    EncoderThread& encoder;
    const Clock& clock;
    const MediaClock& media_clock;
    PipelineCounter* counter;  ///< receives the measurements of each frame; may be null
  };

  /// The first frame of a clip is due at once. `loop`: a clip begins again at its end.
  FramePump(const Parts& parts, bool loop, Wait wait);

  /// Waits until the next frame is due, reads it and processes it. Vision delays frames, because it
  /// needs later frames (lookahead). If a live source delivers no frame for too long, step()
  /// publishes the delayed frames. Otherwise they would arrive late, and the viewers would increase
  /// their playout delay. Throws SourceError.
  PumpStep step();
  /// Publishes the frames that vision still delays, or continues.
  void setPaused(bool paused) override { paused ? flush() : resume(); }
  /// Waits 20 ms, or reads a frame of a live source and drops it. Throws SourceError.
  void idle() override;
  [[nodiscard]] bool canSeek() const override { return !isLive(); }
  /// Continues with the frame at `time_s` of the clip. Vision tracks objects from the first frame
  /// of the clip. So it processes all frames before `time_s` again, but the pump does not publish
  /// them. Ends early as soon as `ends_early` returns true. Requires a source that is not live.
  /// Throws SourceError.
  void seek(double time_s, const std::function<bool()>& ends_early) override;
  bool setSpeed(double /*speed*/) override { return false; }
  void changeMaterials(const Material& change) override;
  void applyReload(const VisionSettings& reloaded) override;
  /// Returns whether the source is live.
  [[nodiscard]] bool isLive() const { return parts_.source.info().live; }
  /// Publishes all frames that vision still delays.
  void flush();
  /// Continues after a time without playback: the next frame is due now.
  void resume() { pacer_.resume(parts_.media_clock.now()); }

  /// Returns the media time of the last frame that the pump passed to the encoder.
  [[nodiscard]] MediaTime lastPublished() const { return last_published_; }
  /// Returns the number of frames that were skipped because they were late.
  [[nodiscard]] std::uint64_t skipped() const { return pacer_.skipped(); }

 private:
  [[nodiscard]] std::optional<RgbdFrame> readFrame();
  [[nodiscard]] MediaTime findMediaTime(const RgbdFrame& frame);
  void process(const RgbdFrame& frame);
  void publish(VisionResult result);
  void publishHeldBack();
  void setMaterials();
  void logSkippedFrames();

  Parts parts_;
  bool loop_;
  Wait wait_;
  Pacer pacer_;
  MediaTime last_published_{};
  MediaTime last_captured_{};  // of a live source
  std::uint64_t logged_skipped_ = 0;
  MediaTime last_logged_{};
};

}  // namespace hapticast::server
