// SPDX-License-Identifier: MIT
#include "client/study_run/trial_player.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "client/settings/command_line.hpp"

namespace hapticast::client {

namespace {

constexpr double kBetweenBeeps_s = 0.25;  // a beep lasts 0.15 s
constexpr double kLongestStart_s = 10.0;  // chosen: from a server's scan to its first frame
constexpr double kLongestFade_s = 2.0;    // chosen: four times the fade of a stale stream

Settings makeConditionSettings(const Settings& settings, const Condition& condition) {
  Settings own = settings;
  if (!condition.server.empty()) setServer(own, condition.server);
  own.method = condition.method;
  return own;
}

}  // namespace

WallTime TrialPlayer::start(const std::filesystem::path& recording, MotionFile& motion,
                            std::optional<WallTime> begin) {
  OutputSettings outputs = settings_.outputs;
  outputs.record = recording.string();
  desk_.openRecorder(outputs);
  motion_ = &motion;
  desk_.onReport([this](TickReport& report) { onReport(report); });
  const WallTime now = std::chrono::system_clock::now();
  offset_s_ = std::chrono::duration<double>(now - begin.value_or(now)).count();
  start_ = desk_.clock().now();
  desk_.startLoop();
  return begin.value_or(now);
}

double TrialPlayer::now_s() const { return offset_s_ + toSeconds(desk_.clock().now() - start_); }

void TrialPlayer::turn() {
  desk_.turn(session_ ? session_->stats() : ConnectionStats{.connected = stream_ != nullptr});
  if (session_) session_->setInContact(desk_.lastReport().contact);
  UserInterface& ui = desk_.ui();
  if (!ui.studyInput().stop) return;
  ui.clearStop();
  UserControls controls = ui.userControls();
  ++controls.stop;
  ui.setControls(controls);
  stopped_ = true;
}

void TrialPlayer::onReport(TickReport& report) {
  motion_->append(report, offset_s_ + toSeconds(report.time - start_));
  // A tick with an earlier timing still had the stream before.
  has_frame_ = has_frame_ || (report.lookup == Lookup::kInterpolated && hasStream() &&
                              report.inputs.timing > last_timing_.number);
  device_lost_ = device_lost_ || report.device == DeviceStatus::kLost;
  warm_ = warm_ || (report.safety_actions & bit(SafetyAction::kThermal)) != 0;
  if (!hasStream()) report.lookup = Lookup::kInterpolated;  // no news: a trial has ended
}

std::optional<StudyInput> TrialPlayer::ask(const StudyPrompt& prompt) {
  desk_.ui().setStudyPrompt(prompt);
  const auto has_answer = [&] {
    const StudyInput& input = desk_.ui().studyInput();
    if (prompt.choices.empty()) return input.confirmed;
    return input.choice && *input.choice < prompt.choices.size();
  };
  while (!isInterrupted() && !has_answer()) turn();
  if (isInterrupted()) return std::nullopt;
  StudyInput input = desk_.ui().studyInput();
  desk_.ui().setStudyPrompt({});
  return input;
}

bool TrialPlayer::wait(double seconds, const StudyPrompt& prompt) {
  desk_.ui().setStudyPrompt(prompt);
  const LocalTime end = desk_.clock().now() + fromSeconds(seconds);
  while (!isInterrupted() && desk_.clock().now() < end) turn();
  return !isInterrupted();
}

bool TrialPlayer::beep(int count) {
  for (int i = 0; i < count; ++i) {
    if (i > 0 && !wait(kBetweenBeeps_s)) return false;
    desk_.ui().beep();
  }
  return true;
}

bool TrialPlayer::waitForDevice() {
  const LocalTime latest = desk_.clock().now() + fromSeconds(kLongestStart_s);
  while (!isInterrupted() && desk_.lastReport().device == DeviceStatus::kLost &&
         desk_.clock().now() < latest)
    turn();
  return !isInterrupted() && desk_.lastReport().device != DeviceStatus::kLost;
}

void TrialPlayer::rearm() {
  UserControls controls = desk_.ui().userControls();
  ++controls.rearm;
  desk_.ui().setControls(controls);
  stopped_ = device_lost_ = false;
  constexpr int kMostTurns = 50;  // half a second; a stop or a loss meanwhile keeps the halt
  for (int i = 0; i < kMostTurns && desk_.lastReport().halt != Halt::kNone && !isInterrupted(); ++i)
    turn();
}

void TrialPlayer::changeControls(const Condition& condition) {
  const UserControls& before = desk_.ui().userControls();
  UserControls controls;  // without what a user changed before the study
  controls.stop = before.stop;
  controls.rearm = before.rearm;
  controls.rearm_by_itself = before.rearm_by_itself;
  controls.static_on = condition.static_on;
  controls.dynamic_on = condition.dynamic_on;
  controls.stiffness_factor = condition.stiffness;
  controls.mass_kg = condition.mass_kg;
  controls.method = condition.method;
  controls.surface = condition.surface;
  desk_.ui().setControls(controls);
  desk_.ui().setPictureAhead(fromSeconds(1e-3 * condition.delay_ms));
}

void TrialPlayer::startStream(const Condition& condition, std::uint64_t seed) {
  has_frame_ = device_lost_ = false;
  if (!condition.server.empty()) {
    session_ =
        std::make_unique<Session>(makeConditionSettings(settings_, condition), desk_, last_timing_);
    session_->connect();
    return;
  }
  auto reader = StreamReader::open(condition.recording);
  if (!reader.ok()) throw std::runtime_error(condition.recording + ": " + reader.error().message);
  const TrialStream::Playback playback{.method = condition.method,
                                       .delay = fromSeconds(1e-3 * condition.delay_ms),
                                       .jitter = fromSeconds(1e-3 * condition.jitter_ms),
                                       .seed = seed};
  stream_ = std::make_unique<TrialStream>(std::move(reader).value(), playback, desk_, last_timing_);
}

void TrialPlayer::finishStream() {
  if (stream_) last_timing_ = stream_->finish();
  if (session_) {
    session_->stop();
    last_timing_ = session_->findEnd();
  }
  stream_.reset();
  session_.reset();
}

TrialEnd TrialPlayer::findInterruption() const {
  if (ended()) return TrialEnd::kEnded;
  if (stopped_) return TrialEnd::kStopped;
  if (device_lost_ || desk_.lastReport().halt == Halt::kDeviceLost) return TrialEnd::kDeviceLost;
  return desk_.lastReport().halt == Halt::kTrustLost ? TrialEnd::kTrustLost : TrialEnd::kComplete;
}

TrialEnd TrialPlayer::findTrialEnd() const {
  const TrialEnd end = findInterruption();
  if (end != TrialEnd::kComplete || !has_frame_) return end;
  const bool lost = stream_ ? stream_->failed() : desk_.lastReport().lookup == Lookup::kStale;
  return lost ? TrialEnd::kStreamLost : TrialEnd::kComplete;
}

TrialEnd TrialPlayer::waitForFirstFrame() {
  LocalTime begin = desk_.clock().now();
  while (findTrialEnd() == TrialEnd::kComplete && !has_frame_) {
    if (session_ && session_->stats().isScanning()) begin = desk_.clock().now();
    if (desk_.clock().now() - begin > fromSeconds(kLongestStart_s)) return TrialEnd::kStreamLost;
    turn();
  }
  return findTrialEnd();
}

TrialEnd TrialPlayer::play(const Condition& condition, std::uint64_t seed) {
  desk_.ui().setStudyPrompt({});
  changeControls(condition);
  startStream(condition, seed);
  TrialEnd end = waitForFirstFrame();
  const LocalTime begin = desk_.clock().now();
  onset_s_ = now_s();
  onset_wall_ = std::chrono::system_clock::now();
  while (end == TrialEnd::kComplete &&
         desk_.clock().now() - begin < fromSeconds(condition.seconds)) {
    UserControls controls = desk_.ui().userControls();
    controls.paused =
        condition.pause_at_s && desk_.clock().now() - begin >= fromSeconds(*condition.pause_at_s);
    desk_.ui().setControls(controls);
    turn();
    end = findTrialEnd();
  }
  finishStream();
  const LocalTime latest = desk_.clock().now() + fromSeconds(kLongestFade_s);
  const std::uint64_t last_tick = desk_.lastReport().tick;
  while (desk_.clock().now() < latest &&
         (desk_.lastReport().tick == last_tick || desk_.lastReport().force_N != Vec3::Zero()))
    turn();
  motion_->flush();
  return end == TrialEnd::kComplete ? findInterruption() : end;
}

const LoopStats& TrialPlayer::finish() {
  const LoopStats& loop = desk_.stopLoop();  // first: the force comes down while the stream goes on
  finishStream();
  return loop;
}

}  // namespace hapticast::client
