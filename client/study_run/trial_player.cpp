// SPDX-License-Identifier: MIT
#include "client/study_run/trial_player.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <csignal>
#include <thread>
#include <utility>

#include "client/desk/first_check.hpp"
#include "client/settings/command_line.hpp"
#include "common/cli/run_program.hpp"

namespace hapticast::client {

namespace {

constexpr auto kDeskTurn = std::chrono::milliseconds(10);  // as App
constexpr double kBetweenBeeps_s = 0.25;                   // a beep lasts 0.15 s
constexpr double kLongestStart_s = 10.0;  // chosen: from a server's scan to its first frame
constexpr double kLongestFade_s = 2.0;    // chosen: four times the fade of a stale stream

Settings makeSessionSettings(const Settings& settings, const Condition& condition) {
  Settings own = settings;
  if (!condition.server.empty()) setServer(own, condition.server);
  own.method = condition.method;
  return own;
}

}  // namespace

TrialPlayer::TrialPlayer(const Settings& settings, const Clock& clock, Views views)
    : settings_(settings),
      clock_(clock),
      ui_(settings, std::move(views)),
      local_(settings, clock, ui_),
      profile_(local_.device->profile()),
      reporter_({settings.log_file, settings.fault_folder, ""}) {
  (void)applyStoredCheck(*local_.device, profile_);
  if (!sighupIgnored()) signals_.add(SIGHUP);
  signals_.async_wait([this](const boost::system::error_code& error, int) {
    if (!error) ended_ = true;
  });
}

TrialPlayer::~TrialPlayer() {
  if (loop_) loop_->stop();
  finishStream();
}

bool TrialPlayer::checkDevice() {
  return local_.is_checked ||
         runFirstCheck(*local_.device, clock_, ended_, ui_, [this] { turn(); });
}

WallTime TrialPlayer::start(const std::filesystem::path& recording, MotionFile& motion,
                            std::optional<WallTime> begin) {
  OutputSettings outputs = settings_.outputs;
  outputs.record = recording.string();
  recorder_ = std::make_unique<RunRecorder>(outputs, clock_);
  motion_ = &motion;
  local_.createRenderer(settings_, ui_);
  recorder_->onSettings(local_.renderer_settings);
  ui_.onControls([this](const UserControls& controls) { recorder_->onControls(controls); });
  const WallTime now = std::chrono::system_clock::now();
  offset_s_ = std::chrono::duration<double>(now - begin.value_or(now)).count();
  start_ = clock_.now();
  loop_ = std::make_unique<LoopThread>(*local_.device, *local_.renderer, clock_);
  return begin.value_or(now);
}

double TrialPlayer::now_s() const { return offset_s_ + toSeconds(clock_.now() - start_); }

void TrialPlayer::turn() {
  io_.poll();
  TickReport report;
  while (local_.reports.tryPop(report)) onReport(report);
  if (local_.renderer) reporter_.writeFaults(local_.renderer->recorder());
  local_.device->poll();
  while (const auto line = local_.device->nextMessage()) spdlog::info("{}", *line);
  if (!ui_.update(session_ ? session_->stats() : ConnectionStats{.connected = stream_ != nullptr}))
    ended_ = true;
  if (ui_.studyInput().stop) {
    ui_.clearStop();
    UserControls controls = ui_.userControls();
    ++controls.stop;
    ui_.setControls(controls);
    stopped_ = true;
  }
  std::this_thread::sleep_for(kDeskTurn);
}

void TrialPlayer::onReport(TickReport report) {
  recorder_->onTick(report);
  motion_->append(report, offset_s_ + toSeconds(report.time - start_));
  last_report_ = report;
  // A tick with an earlier timing still had the stream before.
  has_frame_ = has_frame_ || (report.lookup == Lookup::kInterpolated && hasStream() &&
                              report.inputs.timing > last_timing_.number);
  device_lost_ = device_lost_ || report.device == DeviceStatus::kLost;
  warm_ = warm_ || (report.safety_actions & bit(SafetyAction::kThermal)) != 0;
  if (session_) session_->setInContact(report.contact);
  if (!hasStream()) report.lookup = Lookup::kInterpolated;  // no news: a trial has ended
  reporter_.onReport(report, ui_.rearm());
  ui_.onReport(report);
}

std::optional<StudyInput> TrialPlayer::ask(const StudyPrompt& prompt) {
  ui_.setStudyPrompt(prompt);
  const auto has_answer = [&] {
    const StudyInput& input = ui_.studyInput();
    if (prompt.choices.empty()) return input.confirmed;
    return input.choice && *input.choice < prompt.choices.size();
  };
  while (!isInterrupted() && !has_answer()) turn();
  if (isInterrupted()) return std::nullopt;
  StudyInput input = ui_.studyInput();
  ui_.setStudyPrompt({});
  return input;
}

bool TrialPlayer::wait(double seconds, const StudyPrompt& prompt) {
  ui_.setStudyPrompt(prompt);
  const LocalTime end = clock_.now() + fromSeconds(seconds);
  while (!isInterrupted() && clock_.now() < end) turn();
  return !isInterrupted();
}

bool TrialPlayer::beep(int count) {
  for (int i = 0; i < count; ++i) {
    if (i > 0 && !wait(kBetweenBeeps_s)) return false;
    ui_.beep();
  }
  return true;
}

bool TrialPlayer::waitForDevice() {
  const LocalTime latest = clock_.now() + fromSeconds(kLongestStart_s);
  while (!isInterrupted() && last_report_.device == DeviceStatus::kLost && clock_.now() < latest)
    turn();
  return !isInterrupted() && last_report_.device != DeviceStatus::kLost;
}

void TrialPlayer::rearm() {
  UserControls controls = ui_.userControls();
  ++controls.rearm;
  ui_.setControls(controls);
  stopped_ = device_lost_ = false;
  constexpr int kMostTurns = 50;  // half a second; a stop or a loss meanwhile keeps the halt
  for (int i = 0; i < kMostTurns && last_report_.halt != Halt::kNone && !isInterrupted(); ++i)
    turn();
}

void TrialPlayer::changeControls(const Condition& condition) {
  const UserControls& before = ui_.userControls();
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
  ui_.setControls(controls);
  ui_.setPictureAhead(fromSeconds(1e-3 * condition.delay_ms));
}

void TrialPlayer::startStream(const Condition& condition, std::uint64_t seed) {
  has_frame_ = device_lost_ = false;
  const auto picture = [this](const VideoFrame& video, const Workspace& workspace) {
    ui_.onPicture(video, workspace);
  };
  const auto frame = [this](const PlayableReliefs& reliefs) { ui_.onFrame(reliefs); };
  if (!condition.server.empty()) {
    session_settings_ = makeSessionSettings(settings_, condition);
    session_ = std::make_unique<Session>(
        session_settings_, clock_, local_.pool, local_.stream, true,
        Session::Events{.picture = picture, .frame = frame, .ended = [this] { ended_ = true; }},
        recorder_.get(), last_timing_);
    session_->start();
    session_->connect();
    return;
  }
  auto reader = StreamReader::open(condition.recording);
  if (!reader.ok()) throw std::runtime_error(condition.recording + ": " + reader.error().message);
  const TrialStream::Playback playback{.method = condition.method,
                                       .delay = fromSeconds(1e-3 * condition.delay_ms),
                                       .jitter = fromSeconds(1e-3 * condition.jitter_ms),
                                       .seed = seed};
  stream_ = std::make_unique<TrialStream>(
      std::move(reader).value(), playback, clock_, local_.pool, local_.stream, last_timing_,
      TrialStream::Events{.picture = picture, .frame = frame}, recorder_.get());
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
  if (ended_) return TrialEnd::kEnded;
  if (stopped_) return TrialEnd::kStopped;
  if (device_lost_ || last_report_.halt == Halt::kDeviceLost) return TrialEnd::kDeviceLost;
  return last_report_.halt == Halt::kTrustLost ? TrialEnd::kTrustLost : TrialEnd::kComplete;
}

TrialEnd TrialPlayer::findTrialEnd() const {
  const TrialEnd end = findInterruption();
  if (end != TrialEnd::kComplete || !has_frame_) return end;
  const bool lost = stream_ ? stream_->failed() : last_report_.lookup == Lookup::kStale;
  return lost ? TrialEnd::kStreamLost : TrialEnd::kComplete;
}

TrialEnd TrialPlayer::waitForFirstFrame() {
  LocalTime begin = clock_.now();
  while (findTrialEnd() == TrialEnd::kComplete && !has_frame_) {
    const ConnectionStats stats = session_ ? session_->stats() : ConnectionStats{};
    if (stats.connected && stats.scan_share < 1.0) begin = clock_.now();  // as App with --seconds
    if (clock_.now() - begin > fromSeconds(kLongestStart_s)) return TrialEnd::kStreamLost;
    turn();
  }
  return findTrialEnd();
}

TrialEnd TrialPlayer::play(const Condition& condition, std::uint64_t seed) {
  ui_.setStudyPrompt({});
  changeControls(condition);
  startStream(condition, seed);
  TrialEnd end = waitForFirstFrame();
  const LocalTime begin = clock_.now();
  onset_s_ = now_s();
  onset_wall_ = std::chrono::system_clock::now();
  while (end == TrialEnd::kComplete && clock_.now() - begin < fromSeconds(condition.seconds)) {
    UserControls controls = ui_.userControls();
    controls.paused =
        condition.pause_at_s && clock_.now() - begin >= fromSeconds(*condition.pause_at_s);
    ui_.setControls(controls);
    turn();
    end = findTrialEnd();
  }
  finishStream();
  const LocalTime latest = clock_.now() + fromSeconds(kLongestFade_s);
  const std::uint64_t last_tick = last_report_.tick;
  while (clock_.now() < latest &&
         (last_report_.tick == last_tick || last_report_.force_N != Vec3::Zero()))
    turn();
  motion_->flush();
  return end == TrialEnd::kComplete ? findInterruption() : end;
}

const LoopStats& TrialPlayer::finish() {
  finishStream();
  loop_->stop();
  turn();
  motion_->flush();
  ui_.finish();
  return loop_->stats();
}

}  // namespace hapticast::client
