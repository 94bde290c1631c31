// SPDX-License-Identifier: MIT
#include "client/desk/desk.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <thread>
#include <utility>

#include "client/desk/first_check.hpp"
#include "common/cli/run_program.hpp"

namespace hapticast::client {

namespace {

/// Waits for the next turn. Chosen: a window that is drawn in every turn moves smoothly.
void waitForTurn() { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }

void logRealtime(const RealtimeGrant& realtime) {
  if (realtime.fifo && realtime.mlock) return;
  spdlog::info("the loop ran without {}: ticks may be late under load (README: real time)",
               realtime.fifo    ? "locked memory"
               : realtime.mlock ? "SCHED_FIFO"
                                : "SCHED_FIFO and locked memory");
}

}  // namespace

Desk::Desk(const Settings& settings, const Clock& clock, Views views)
    : settings_(settings),
      clock_(clock),
      ui_(settings, std::move(views)),
      local_(settings, clock, ui_),
      signalled_(stopAtSignals()),
      reporter_(settings.log_file, settings.fault_folder, settings.summary_file) {}

bool Desk::checkDevice() {
  return local_.is_checked || runFirstCheck(*local_.device, clock_, stop_, ui_, [this] {
           waitForTurn();
           local_.device->poll();  // the check logs its messages
           updateViews({});
         });
}

void Desk::openRecorder(const OutputSettings& outputs) {
  if (outputs.wanted()) recorder_ = std::make_unique<RunRecorder>(outputs, clock_);
}

void Desk::startLoop() {
  local_.createRenderer(settings_, ui_);
  if (recorder_) {
    recorder_->onSettings(local_.renderer_settings);
    ui_.onControls([this](const UserControls& controls) { recorder_->onControls(controls); });
  }
  loop_.emplace(*local_.device, *local_.renderer, clock_);
}

void Desk::turn(const ConnectionStats& stats) {
  waitForTurn();
  processReports();
  updateViews(stats);
}

void Desk::processReports() {
  TickReport report;
  while (local_.reports.tryPop(report)) {
    if (recorder_) recorder_->onTick(report);
    last_report_ = report;
    if (on_report_) on_report_(report);
    reporter_.onReport(report, ui_.rearm());
    ui_.onReport(report);
  }
  if (local_.renderer) reporter_.writeFaults(local_.renderer->recorder());
  local_.device->poll();
  while (const auto line = local_.device->nextMessage()) spdlog::info("{}", *line);
}

void Desk::updateViews(const ConnectionStats& stats) {
  if (!ui_.update(stats) || signalled_) stop();  // the first check reads the flag alone
}

const LoopStats& Desk::stopLoop() {
  loop_->stop();
  processReports();
  return loop_->stats();
}

bool Desk::finish(RunResult& run) {
  logRealtime(loop_->realtime());
  if (local_.renderer->droppedReports() > 0)
    spdlog::warn("{} ticks are missing in the files of the run", local_.renderer->droppedReports());
  run.loop = loop_->stats();
  run.playout_delay_ms = toSeconds(local_.renderer->report().playout_delay) * 1e3;
  run.eye_hand_ns = ui_.eyeHand();
  run.device = local_.device->traffic();
  run.realtime = loop_->realtime();
  const bool is_reported = reporter_.finish(run);
  const bool is_shown = ui_.finish();
  const bool is_recorded = !recorder_ || succeed([this] { recorder_->finish(); });
  return is_reported && is_shown && is_recorded;
}

}  // namespace hapticast::client
