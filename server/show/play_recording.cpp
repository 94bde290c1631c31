// SPDX-License-Identifier: MIT
#include "server/show/play_recording.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "common/playback/recording_player.hpp"
#include "common/recording/recorder.hpp"
#include "server/pipeline/control_queue.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/show/origin.hpp"
#include "server/stream/limited_log.hpp"

namespace hapticast::server {

namespace {

/// Plays one recording to one origin.
class Playback {
 public:
  Playback(const Settings& settings, const Clock& clock, ReadSettings reread);
  void run();

 private:
  void waitForViewer();
  void playAll();
  void carryOutRequests();
  void publish(RecordedItem item);
  /// Describes the stream to all receivers, if it changed.
  void describeStream();
  void logEnd();
  /// Waits until `due`, a signal, or with `for_requests` a request. Returns whether it waited until
  /// `due`.
  bool waitUntil(MediaTime due, bool for_requests = false);

  const Settings& settings_;
  RecordingPlayer player_;
  LocalMediaClock media_clock_;
  Reloader reloader_;
  ControlQueue requests_;
  LimitedLog log_;
  PipelineCounter counter_;
  StreamDescription recorded_;     // the newest description in the recording
  StreamDescription description_;  // that of the viewers
  Origin origin_;
  FrameEncoder encoder_;
  Material material_;  // operators' values
  std::atomic<bool> stop_{false};
  bool paused_ = false;
  std::uint64_t frames_ = 0;
};

Playback::Playback(const Settings& settings, const Clock& clock, ReadSettings reread)
    : settings_(settings),
      player_(openRecording(settings.source), settings.loop),
      media_clock_(clock, player_.reader().begin()),
      reloader_(settings, std::move(reread), clock),
      log_(clock),
      counter_(clock),
      recorded_(player_.reader().description()),
      description_(describePlayback(recorded_, 1.0, settings.name)),
      origin_(settings, clock, media_clock_, description_) {}

void Playback::run() {
  origin_.start([this] { stop_ = true; }, [this] { (void)reloader_.reload(); },
                [this](const Control& control, std::function<void()> confirm) {
                  requests_.push(control, std::move(confirm));
                },
                [this](Metrics& metrics) { metrics.pipeline = counter_.counts(); });
  StreamService& service = origin_.service();
  service.open(description_.name);
  if (settings_.wait_for_viewer) waitForViewer();
  const StreamReader& reader = player_.reader();
  spdlog::info("streaming {} ({} x {}, {:g} frames/s, {:.1f} s)", settings_.source,
               description_.workspace.width_px, description_.workspace.height_px, description_.fps,
               toSeconds(reader.length()));
  for (StreamSink* sink : origin_.sinks()) sink->describe(description_);
  counter_.enter(PipelinePhase::kStream);
  playAll();
  logEnd();
  waitUntil(media_clock_.now() + description_.pipeline_latency + kPlayout);
  service.end();
}

void Playback::waitForViewer() {
  if (origin_.service().broadcaster().viewers() > 0) return;
  counter_.enter(PipelinePhase::kWaitForViewer);
  spdlog::info("waiting for the first viewer");
  while (!stop_ && origin_.service().broadcaster().viewers() == 0)
    waitUntil(media_clock_.now() + kSlice);
}

void Playback::playAll() {
  while (!stop_) {
    origin_.service().manager().reportAlive();
    carryOutRequests();
    if (paused_) {
      waitUntil(media_clock_.now() + kSlice);
      continue;
    }
    const auto due = player_.prepare(media_clock_.now());
    const bool was_last = settings_.frames != 0 && frames_ >= settings_.frames;
    if (!due || (was_last && player_.hasFrame())) return;
    if (waitUntil(*due, true)) publish(player_.take());
  }
}

bool Playback::waitUntil(MediaTime due, bool for_requests) {
  while (!stop_) {
    origin_.service().manager().reportAlive();
    const Duration left = due - media_clock_.now();
    if (left <= Duration::zero()) return true;
    if (for_requests && requests_.waits()) return false;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
  return false;
}

void Playback::carryOutRequests() {
  const auto merged = requests_.take();
  if (!merged) return;
  const Control& request = merged->request;
  if (request.paused && *request.paused != paused_) {
    paused_ = *request.paused;
    counter_.enter(paused_ ? PipelinePhase::kPause : PipelinePhase::kStream);
    log_.info(fmt::format("an operator {} the stream", paused_ ? "pauses" : "continues"));
    if (!paused_) player_.resume();
  }
  if (request.seek_s) {
    player_.seek(*request.seek_s);
    log_.info(fmt::format("an operator seeks to {:g} s", *request.seek_s));
  }
  if (request.speed) {
    player_.setSpeed(*request.speed);
    describeStream();
    log_.info(fmt::format("an operator sets the speed to {:g}", *request.speed));
  }
  if (request.material != Material{}) {
    changeMaterial(request.material, material_);
    log_.info("an operator changes the material");
  }
  merged->confirmAll();
}

void Playback::publish(RecordedItem item) {
  const std::vector<StreamSink*> sinks = origin_.sinks();
  if (auto* const description = std::get_if<StreamDescription>(&item)) {
    recorded_ = std::move(*description);
    describeStream();
  } else if (auto* const frame = std::get_if<CodedFrame>(&item)) {
    ++frames_;
    if (settings_.http) counter_.set(0, {}, origin_.signer().signingTime());
    for (CodedObject& object : frame->objects) changeMaterial(material_, object.material);
    if (const auto key = origin_.signer().rotateKey())
      for (StreamSink* sink : sinks) sink->changeKey(*key);
    const EncodedFrame encoded =
        encoder_.encode(std::move(*frame), &origin_.signer(), areDatagramsWanted(sinks));
    for (StreamSink* sink : sinks) sink->publish(encoded);
  } else if (isVideoWanted(sinks)) {
    const EncodedVideo video = encodeVideo(std::move(std::get<VideoFrame>(item)));
    for (StreamSink* sink : sinks) sink->publish(video);
  }
}

void Playback::describeStream() {
  const StreamDescription description =
      describePlayback(recorded_, player_.speed(), settings_.name);
  if (description == description_) return;
  description_ = description;
  for (StreamSink* sink : origin_.sinks()) sink->describe(description_);
}

void Playback::logEnd() {
  const StreamReader& reader = player_.reader();
  if (!player_.problem().empty())
    spdlog::warn("{} {}: it plays for {:.1f} s", settings_.source, player_.problem(),
                 toSeconds(player_.played()));
  if (reader.leftOut() > 0)
    spdlog::warn("{}: {} frames are left out, because their times run back", settings_.source,
                 reader.leftOut());
}

}  // namespace

StreamReader openRecording(const std::string& file) {
  auto opened = StreamReader::open(file);
  if (!opened.ok()) throw RecordingError("--source " + file + ": " + opened.error().message);
  return std::move(opened).value();
}

void playRecording(const Settings& settings, const Clock& clock, ReadSettings reread) {
  Playback(settings, clock, std::move(reread)).run();
}

}  // namespace hapticast::server
