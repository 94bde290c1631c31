// SPDX-License-Identifier: MIT
#include "client/commands/touch_command.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "client/desk/first_check.hpp"
#include "client/desk/local_device.hpp"
#include "client/desk/run_recorder.hpp"
#include "client/desk/session.hpp"
#include "client/desk/user_interface.hpp"
#include "client/loop/loop.hpp"
#include "client/report/reporter.hpp"

namespace hapticast::client {

namespace {

// Chosen: a window that is drawn in every turn moves smoothly.
constexpr auto kTurn = std::chrono::milliseconds(10);

std::unique_ptr<RunRecorder> openRecorder(const Settings& settings, const Clock& clock) {
  if (!settings.outputs.wanted()) return nullptr;
  return std::make_unique<RunRecorder>(settings.outputs, clock);
}

void logRealtime(const RealtimeGrant& realtime) {
  if (realtime.fifo && realtime.mlock) return;
  spdlog::info("the loop ran without {}: ticks may be late under load (README: real time)",
               realtime.fifo    ? "locked memory"
               : realtime.mlock ? "SCHED_FIFO"
                                : "SCHED_FIFO and locked memory");
}

}  // namespace

class App::Impl {
 public:
  Impl(Settings settings, const Clock& clock, Views views);

  bool run();
  void stop() noexcept { stop_ = true; }

 private:
  bool checkFirst();
  void runEvents();
  void readReports();
  bool finish(const LoopThread& loop);
  HapticDevice& device() { return *local_.device; }

  const Settings settings_;
  const Clock& clock_;
  UserInterface ui_;
  LocalDevice local_;
  std::atomic<bool> stop_{false};
  std::unique_ptr<RunRecorder> recorder_;  // null: no recording
  Session session_;                        // its network thread uses everything above
  Reporter reporter_;
  TickReport last_report_;  // of those read from local_.reports
  bool any_frame_ = false;
  bool time_is_over_ = false;
};

App::Impl::Impl(Settings settings, const Clock& clock, Views views)
    : settings_(std::move(settings)),
      clock_(clock),
      ui_(settings_, std::move(views)),
      local_(settings_, clock, ui_),
      recorder_(openRecorder(settings_, clock)),
      session_(
          settings_, clock, local_.pool, local_.stream, ui_.wantsVideo() || recorder_ != nullptr,
          {.picture = [this](const VideoFrame& picture,
                             const Workspace& workspace) { ui_.onPicture(picture, workspace); },
           .frame = [this](const PlayableReliefs& frame) { ui_.onFrame(frame); },
           .ended = [this] { stop(); }},
          recorder_.get()),
      reporter_({settings_.log_file, settings_.fault_folder, settings_.summary_file}) {
  requireWritable("--summary", settings_.summary_file);
}

bool App::Impl::run() {
  session_.start();
  if (!checkFirst()) {
    session_.stop();
    return true;
  }
  spdlog::info("connecting to {} with a {}. Ctrl-C ends the client.", session_.serverName(),
               device().description());
  if (settings_.forces != Forces::kBoth)
    spdlog::info("the client renders only the {} force (--forces)",
                 settings_.forces == Forces::kStatic ? "static" : "dynamic");
  local_.createRenderer(settings_, ui_);
  if (recorder_) {
    recorder_->onSettings(local_.renderer_settings);
    ui_.onControls([this](const UserControls& controls) { recorder_->onControls(controls); });
  }
  session_.connect();
  LoopThread loop(device(), *local_.renderer, clock_);
  runEvents();
  loop.stop();
  device().poll();
  readReports();
  session_.stop();
  return finish(loop);
}

/// Checks a device that was never checked. Returns false if the client has to end.
bool App::Impl::checkFirst() {
  return local_.is_checked || runFirstCheck(device(), clock_, stop_, ui_, [this] {
           device().poll();
           if (!ui_.update(session_.stats())) stop();
           std::this_thread::sleep_for(kTurn);
         });
}

void App::Impl::runEvents() {
  LocalTime begin = clock_.now();  // of --seconds
  while (!stop_ && !time_is_over_) {
    readReports();
    reporter_.writeFaults(local_.renderer->recorder());
    device().poll();
    while (const auto line = device().nextMessage()) spdlog::info("{}", *line);
    session_.setInContact(last_report_.contact);
    const ConnectionStats& stats = session_.stats();
    if (!ui_.update(stats)) stop();
    if (const auto control = ui_.takeControl()) session_.control(*control);
    // The time does not run during the scan of a clip, and begins again with the first frame.
    const bool first = !any_frame_ && last_report_.lookup != Lookup::kEmpty;
    if (first || (!any_frame_ && stats.connected && stats.scan_share < 1.0)) begin = clock_.now();
    any_frame_ = any_frame_ || first;
    if (const auto text = session_.listServers(clock_.now())) spdlog::warn("{}", *text);
    std::this_thread::sleep_for(kTurn);
    time_is_over_ =
        settings_.seconds > 0.0 && clock_.now() - begin >= fromSeconds(settings_.seconds);
  }
}

void App::Impl::readReports() {
  while (local_.reports.tryPop(last_report_)) {
    if (recorder_) recorder_->onTick(last_report_);
    reporter_.onReport(last_report_, ui_.rearm());
    ui_.onReport(last_report_);
  }
}

bool App::Impl::finish(const LoopThread& loop) {
  reporter_.writeFaults(local_.renderer->recorder());
  bool ok = !session_.failed();
  if (const auto reason = session_.neverConnected(); ok && time_is_over_ && reason) {
    spdlog::error("no server answered at {} within {:g} s ({})", session_.serverName(),
                  settings_.seconds, *reason);
    ok = false;
  }
  logRealtime(loop.realtime());
  if (local_.renderer->droppedReports() > 0)
    spdlog::warn("{} ticks are missing in the log", local_.renderer->droppedReports());
  RunResult run;
  run.loop = loop.stats();
  run.playout_delay_ms = toSeconds(local_.renderer->report().playout_delay) * 1e3;
  run.eye_hand_ns = ui_.eyeHand();
  run.device = device().traffic();
  run.realtime = loop.realtime();
  session_.addTo(run);
  reporter_.finish(run);
  ui_.finish();
  if (!settings_.quiet && ok) std::fputs(toText(run).c_str(), stdout);
  return ok;
}

App::App(Settings settings, const Clock& clock, Views views)
    : impl_(std::make_unique<Impl>(std::move(settings), clock, std::move(views))) {}

App::~App() = default;

bool App::run() { return impl_->run(); }

void App::stop() noexcept { impl_->stop(); }

}  // namespace hapticast::client
