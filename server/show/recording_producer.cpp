// SPDX-License-Identifier: MIT
#include "server/show/producers.hpp"

#include <spdlog/spdlog.h>

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/playback/recording_player.hpp"
#include "common/recording/progress_log.hpp"
#include "common/recording/recorder.hpp"
#include "server/pipeline/control_queue.hpp"
#include "server/show/show.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

StreamReader openRecording(const std::string& file) {
  auto opened = StreamReader::open(file, logScan(file));
  if (!opened.ok()) throw RecordingError("--source " + file + ": " + opened.error().message);
  return std::move(opened).value();
}

namespace {

class RecordingProducer final : public Producer, public OperatedStream {
 public:
  RecordingProducer(const Settings& settings, const Clock& clock);

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override { return description_; }
  [[nodiscard]] OperatedStream* operated() override { return this; }
  void start() override;
  bool step() override;
  bool finish() override;

  void setPaused(bool paused) override;
  void idle() override;
  void seek(double time_s, const std::function<bool()>& ends_early) override;
  bool setSpeed(double speed) override;
  void changeMaterials(const Material& change) override;

 private:
  void publish(RecordedItem item);
  void publish(CodedFrame frame);
  /// Describes the stream to all receivers, if it changed.
  void describeStream();

  const Settings& settings_;
  RecordingPlayer player_;
  LocalMediaClock media_clock_;
  StreamDescription recorded_;     // the newest description in the recording
  StreamDescription description_;  // that of the viewers
  FrameEncoder encoder_;
  Material material_;  // operators' values
  std::uint64_t frames_ = 0;
};

RecordingProducer::RecordingProducer(const Settings& settings, const Clock& clock)
    : settings_(settings),
      player_(openRecording(settings.source), settings.loop),
      media_clock_(clock, player_.reader().begin()),
      recorded_(player_.reader().description()),
      description_(describePlayback(recorded_, 1.0, settings.name)) {}

void RecordingProducer::start() {
  spdlog::info("streaming {} ({} x {}, {:g} frames/s, {:.1f} s)", settings_.source,
               description_.workspace.width_px, description_.workspace.height_px, description_.fps,
               toSeconds(player_.reader().length()));
  for (StreamSink* sink : show_->sinks().all()) sink->describe(description_);
}

bool RecordingProducer::step() {
  const auto due = player_.prepare(media_clock_.now());
  const bool was_last = settings_.frames != 0 && frames_ >= settings_.frames;
  if (!due || (was_last && player_.hasFrame())) return false;
  if (show_->waitUntil(*due, Show::Until::kDueOrRequest)) publish(player_.take());
  return true;
}

bool RecordingProducer::finish() {
  const StreamReader& reader = player_.reader();
  if (!player_.problem().empty())
    spdlog::warn("{} {}: it plays for {:.1f} s", settings_.source, player_.problem(),
                 toSeconds(player_.played()));
  if (reader.leftOut() > 0)
    spdlog::warn("{}: {} frames are left out, because their times run back", settings_.source,
                 reader.leftOut());
  (void)show_->waitUntil(media_clock_.now() + description_.pipeline_latency + Show::kPlayout);
  return true;
}

void RecordingProducer::setPaused(bool paused) {
  if (!paused) player_.resume();
}

void RecordingProducer::idle() { (void)show_->waitUntil(media_clock_.now() + Show::kSlice); }

void RecordingProducer::seek(double time_s, const std::function<bool()>& /*ends_early*/) {
  player_.seek(time_s);
}

bool RecordingProducer::setSpeed(double speed) {
  player_.setSpeed(speed);
  describeStream();
  return true;
}

void RecordingProducer::changeMaterials(const Material& change) {
  changeMaterial(change, material_);
}

void RecordingProducer::publish(RecordedItem item) {
  if (auto* const description = std::get_if<StreamDescription>(&item)) {
    recorded_ = std::move(*description);
    describeStream();
  } else if (auto* const frame = std::get_if<CodedFrame>(&item)) {
    publish(std::move(*frame));
  } else if (const auto sinks = show_->sinks().all(); isVideoWanted(sinks)) {
    const EncodedVideo video = encodeVideo(std::move(std::get<VideoFrame>(item)));
    for (StreamSink* sink : sinks) sink->publish(video);
  }
}

void RecordingProducer::publish(CodedFrame frame) {
  ++frames_;
  FrameSigner& signer = show_->sinks().signer();
  const std::vector<StreamSink*> sinks = show_->sinks().all();
  if (settings_.http) show_->counter().set(0, {}, signer.signingTime());
  for (CodedObject& object : frame.objects) changeMaterial(material_, object.material);
  rotateKey(signer, sinks);
  const EncodedFrame encoded =
      encoder_.encode(std::move(frame), &signer, areDatagramsWanted(sinks));
  for (StreamSink* sink : sinks) sink->publish(encoded);
}

void RecordingProducer::describeStream() {
  const StreamDescription description =
      describePlayback(recorded_, player_.speed(), settings_.name);
  if (description == description_) return;
  description_ = description;
  for (StreamSink* sink : show_->sinks().all()) sink->describe(description_);
}

}  // namespace

std::unique_ptr<Producer> makeRecordingProducer(const Settings& settings, const Clock& clock) {
  return std::make_unique<RecordingProducer>(settings, clock);
}

}  // namespace hapticast::server
