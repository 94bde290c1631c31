// SPDX-License-Identifier: MIT
#include "client/study_run/study_command.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "client/study/events_file.hpp"
#include "client/study/study_file.hpp"
#include "client/study/study_folder.hpp"
#include "client/study/trial_schedule.hpp"
#include "client/study_run/study_checks.hpp"
#include "client/study_run/study_trials.hpp"
#include "common/cli/run_program.hpp"
#include "common/json/json_error.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

namespace {

/// Sends the events of a study as datagrams, for a recorder beside it.
class MarkerSender {
 public:
  /// Throws std::runtime_error (one line) if the address cannot be resolved.
  explicit MarkerSender(const Endpoint& to) {
    boost::system::error_code error;
    asio::ip::udp::resolver resolver(io_);
    const auto found = resolver.resolve(to.host, std::to_string(to.port), error);
    if (error || found.empty())
      throw std::runtime_error("--markers " + to.host + ": " + error.message());
    to_ = *found.begin();
    socket_.open(to_.protocol());
    socket_.non_blocking(true);
  }
  /// Sends a line. A lost datagram is no error.
  void send(const std::string& line) {
    boost::system::error_code error;
    socket_.send_to(asio::buffer(line), to_, 0, error);
  }

 private:
  asio::io_context io_;
  asio::ip::udp::endpoint to_;
  asio::ip::udp::socket socket_{io_};
};

Study readStudy(const std::string& text, const std::string& file) {
  Study study = parseStudy(text);
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  for (Condition& condition : study.conditions)
    if (!condition.recording.empty()) condition.recording = (folder / condition.recording).string();
  return study;
}

void requireWindow(const StudySettings& study, const Views& views) {
  for (const auto& view : views)
    if (view->points()) return;
  if (!study.simulate)
    throw std::runtime_error("--study " + study.file +
                             ": needs a window (--view on) for its prompts, or --simulate");
}

/// The run of a study with one subject, after all checks that need no subject.
class SubjectRun {
 public:
  /// Throws std::runtime_error (one line) if the subject cannot begin, or cannot continue.
  SubjectRun(const Settings& settings, const Study& study, const std::string& text,
             TrialPlayer& player);
  /// Runs the study. Returns the exit code.
  int run();

 private:
  void restore(const std::vector<TrialRow>& rows);
  void begin();
  bool finish(bool complete);
  void printThresholds() const;
  void onEvent(const std::string& event);

  const StudySettings& settings_;
  const Study& study_;
  const std::string& text_;
  TrialPlayer& player_;
  StudyFolder folder_;
  TrialSchedule schedule_;
  std::optional<WallTime> start_;  // of the motion file
  std::optional<EventsFile> events_;
  std::optional<MotionFile> motion_;
  std::optional<MarkerSender> markers_;
  std::optional<SimulatedObserver> observer_;
};

SubjectRun::SubjectRun(const Settings& settings, const Study& study, const std::string& text,
                       TrialPlayer& player)
    : settings_(settings.study),
      study_(study),
      text_(text),
      player_(player),
      folder_(settings_.out, study, settings_.subject),
      schedule_(study, settings_.subject) {
  requireSpace(study, settings_.out);
  if (settings_.markers) markers_.emplace(*settings_.markers);
  if (settings_.simulate)
    observer_.emplace(*settings_.simulate, study.seed + toSubjectNumber(settings_.subject));
  if (!settings_.resume) {
    folder_.requireNew();
    return;
  }
  start_ = folder_.resume(text, observer_.has_value());
  events_.emplace(folder_.eventsFile(), true);
  restore(events_->rows());
}

/// Repeats the trials of `rows`. Throws std::runtime_error if they are not those of the study.
void SubjectRun::restore(const std::vector<TrialRow>& rows) {
  for (const TrialRow& row : rows) {
    const auto trial = schedule_.findTrial();
    if (!trial || trial->number != row.trial || trial->is_training != row.is_training ||
        trial->level != row.level ||
        (trial->level && row.comparison_interval != (trial->comparison_first ? 1 : 2)) ||
        schedule_.code(trial->condition) != row.condition)
      throw std::runtime_error(
          fmt::format("{}: row {} is no trial of this study; was the file "
                      "changed?",
                      folder_.eventsFile().string(), row.trial));
    if (row.answer)
      schedule_.onAnswer(row.is_correct.value_or(true));
    else
      schedule_.onVoid();
  }
}

/// Creates the files of a new subject, and starts the loop.
void SubjectRun::begin() {
  if (!settings_.resume) folder_.create();
  motion_.emplace(folder_.motionFile());
  start_ = player_.start(folder_.nextRecording(), *motion_, start_);
  if (settings_.resume) return;
  std::vector<std::string> codes;
  for (std::size_t i = 0; i < study_.conditions.size(); ++i) codes.push_back(schedule_.code(i));
  folder_.begin({.study_text = text_,
                 .codes = codes,
                 .device = player_.desk().local().device->description(),
                 .is_simulated = observer_.has_value(),
                 .start = *start_});
  events_.emplace(folder_.eventsFile(), false);  // last: from now on the subject has begun
}

int SubjectRun::run() {
  if (schedule_.countRemaining() == 0) {
    spdlog::info("the study of this subject is complete");
    printThresholds();
    return kDone;
  }
  if (!observer_ && !askConsent(study_, player_)) return kFailed;
  begin();
  StudyTrials trials({study_, schedule_, *events_, player_, observer_,
                      [this](const std::string& event) { onEvent(event); }});
  bool complete = false;
  const bool is_stored = succeed([&] { complete = trials.run(); });  // else: such as a full disk
  if (!finish(complete) || !is_stored || !complete) return kFailed;
  printThresholds();
  return kDone;
}

/// Ends the loop and completes all files. Returns false if a file is not complete.
bool SubjectRun::finish(bool complete) {
  const LoopStats& loop = player_.finish();
  const bool is_described = succeed([this] { folder_.finish(player_.now_s()); });
  const bool is_flushed = succeed([this] { motion_->flush(); });
  spdlog::info("largest step of the force beyond the limits: {:g} N; work on the hand: {:.2f} mJ",
               loop.step_excess_max_N, loop.work.user_mJ());
  if (!complete)
    spdlog::warn("{} trials are left: continue with --resume", schedule_.countRemaining());
  RunResult run;
  return player_.desk().finish(run) && is_described && is_flushed;
}

void SubjectRun::printThresholds() const {
  if (!study_.comparison) return;
  for (std::size_t i = 0; i < study_.conditions.size(); ++i) {
    const ThresholdPosterior& posterior = schedule_.posterior(i);
    fmt::print("condition {}: JND {:.4g}, with 95 % probability {:.4g} to {:.4g}\n",
               schedule_.code(i), posterior.computeMedian(), posterior.computeQuantile(0.025),
               posterior.computeQuantile(0.975));
  }
}

void SubjectRun::onEvent(const std::string& event) {
  if (!markers_) return;
  markers_->send(fmt::format("hapticast sub-{} task-{} {} {}\n", settings_.subject, study_.name,
                             event, formatIso8601(std::chrono::system_clock::now())));
}

}  // namespace

int runStudy(const Settings& settings, const Clock& clock) {
  const StudySettings& own = settings.study;
  Views views = openViews(settings);
  try {
    requireWindow(own, views);
    const std::string text = readStudyText(own.file);
    const Study study = readStudy(text, own.file);
    Desk desk(settings, clock, std::move(views));
    if (own.simulate && desk.local().is_auto_detected)
      throw std::runtime_error(
          "--simulate: name the device (--device virtual); no person holds the one that was found");
    requireRenderable(study, desk.local().profile, settings.stiffness_limit_N_mm);
    TrialPlayer player(settings, desk);
    SubjectRun run(settings, study, text, player);
    bool is_checked = false;
    if (!succeed([&] { is_checked = desk.checkDevice(); }) || !is_checked) return kFailed;
    return run.run();
  } catch (const JsonError& error) {
    throw std::runtime_error(describe(own.file, error));
  }
}

}  // namespace hapticast::client
