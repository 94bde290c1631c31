// SPDX-License-Identifier: MIT
#include "client/study_command.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include "client/device/device_request.hpp"
#include "client/study/events_file.hpp"
#include "client/study/located_json.hpp"
#include "client/study/study_file.hpp"
#include "client/study/study_folder.hpp"
#include "client/study/trial_schedule.hpp"
#include "client/study_checks.hpp"
#include "client/study_trials.hpp"
#include "common/cli/run_program.hpp"
#include "common/text.hpp"
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

/// Repeats the trials of `rows`. Throws std::runtime_error if they are not those of the study.
void restore(TrialSchedule& schedule, const std::vector<TrialRow>& rows,
             const std::filesystem::path& file) {
  for (const TrialRow& row : rows) {
    const auto trial = schedule.findTrial();
    if (!trial || trial->number != row.trial || trial->is_training != row.is_training ||
        trial->level != row.level || schedule.code(trial->condition) != row.condition)
      throw std::runtime_error(fmt::format(
          "{}: row {} is no trial of this study; was the file changed?", file.string(), row.trial));
    if (row.answer)
      schedule.onAnswer(row.is_correct.value_or(true));
    else
      schedule.onVoid();
  }
}

std::vector<std::string> listCodes(const Study& study, const TrialSchedule& schedule) {
  std::vector<std::string> codes;
  for (std::size_t i = 0; i < study.conditions.size(); ++i) codes.push_back(schedule.code(i));
  return codes;
}

void printThresholds(const Study& study, const TrialSchedule& schedule) {
  if (!study.comparison) return;
  for (std::size_t i = 0; i < study.conditions.size(); ++i) {
    const ThresholdPosterior& posterior = schedule.posterior(i);
    fmt::print("condition {}: JND {:.4g}, with 95 % probability {:.4g} to {:.4g}\n",
               schedule.code(i), posterior.computeMedian(), posterior.computeQuantile(0.025),
               posterior.computeQuantile(0.975));
  }
}

/// Runs the trials of a study that passed all checks.
int runTrials(const Settings& settings, const Study& study, const std::string& text,
              StudyDesk& desk) {
  const StudySettings& own = settings.study;
  StudyFolder folder(own.out, study, own.subject);
  TrialSchedule schedule(study, own.subject);
  const WallTime now = std::chrono::system_clock::now();
  if (!own.resume) folder.create();
  const WallTime start = own.resume ? folder.resume(text) : now;
  EventsFile events(folder.eventsFile(), own.resume);
  restore(schedule, events.rows(), folder.eventsFile());
  if (schedule.countRemaining() == 0) {
    spdlog::info("the study of this subject is complete");
    printThresholds(study, schedule);
    return kDone;
  }
  requireSpace(study, schedule.countRemaining(), own.out);
  if (!own.resume) folder.begin(text, listCodes(study, schedule), desk.deviceName(), start);
  MotionFile motion(folder.motionFile());
  std::optional<MarkerSender> markers;
  if (own.markers) markers.emplace(*own.markers);
  const auto on_event = [&](const std::string& event) {
    if (markers)
      markers->send(fmt::format("hapticast sub-{} task-{} {} {}\n", own.subject, study.name, event,
                                formatIso8601(std::chrono::system_clock::now())));
  };
  std::optional<SimulatedObserver> observer;
  if (own.simulate)
    observer.emplace(*own.simulate, study.seed + std::hash<std::string>{}(own.subject));
  desk.start(folder.nextRecording(), motion, std::chrono::duration<double>(now - start).count());
  StudyTrials trials({study, schedule, events, desk, observer, on_event});
  const bool complete = trials.run();
  const LoopStats& loop = desk.finish();
  folder.finish(desk.now_s());
  spdlog::info("largest step of the force beyond the limits: {:g} N; work on the hand: {:.2f} mJ",
               loop.step_excess_max_N, loop.work.user_mJ());
  if (complete) printThresholds(study, schedule);
  if (!complete)
    spdlog::warn("{} trials are left: continue with --resume", schedule.countRemaining());
  return complete ? kDone : kFailed;
}

}  // namespace

int runStudy(const Settings& settings, const Clock& clock, Views views) {
  const StudySettings& own = settings.study;
  const auto refuse = [](const std::string& what) {
    spdlog::error("{}", sanitizeUtf8(what));
    return kWrongInput;
  };
  try {
    requireWindow(own, views);
    const std::string text = readStudyText(own.file);
    const Study study = readStudy(text, own.file);
    StudyDesk desk(settings, clock, std::move(views));
    requireRenderable(study, desk.profile(), settings.stiffness_limit_N_mm);
    if (!desk.checkDevice()) return kFailed;
    return runTrials(settings, study, text, desk);
  } catch (const DeviceAbsent& error) {
    spdlog::error("{}", sanitizeUtf8(error.what()));
    return kFailed;
  } catch (const LocatedError& error) {
    return refuse(fmt::format("{}:{}: {}", own.file, error.line, error.what()));
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

}  // namespace hapticast::client
