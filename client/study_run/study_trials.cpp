// SPDX-License-Identifier: MIT
#include "client/study_run/study_trials.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <string>

#include "client/study/study_folder.hpp"

namespace hapticast::client {

namespace {

constexpr double kBetweenIntervals_s = 0.5;   // chosen
constexpr double kRestInTimeConstants = 3.0;  // the heat of the motors falls to 5 %

const char* toStatus(TrialEnd end) {
  switch (end) {
    case TrialEnd::kStopped:
      return "stopped";
    case TrialEnd::kDeviceLost:
      return "device_lost";
    case TrialEnd::kStreamLost:
      return "stream_lost";
    case TrialEnd::kTrustLost:
      return "trust_lost";
    default:
      return "valid";
  }
}

const char* describeInterruption(TrialEnd end) {
  switch (end) {
    case TrialEnd::kDeviceLost:
      return "The device did not answer. Check its cable and its power.";
    case TrialEnd::kStreamLost:
      return "The stream was interrupted.";
    case TrialEnd::kTrustLost:
      return "The client switched the force off, because the stream is not safe.";
    default:
      return "The force is off.";
  }
}

StudyPrompt makeQuestionPrompt(const Question& question) {
  StudyPrompt prompt{.text = question.text, .low = question.low, .high = question.high};
  switch (question.kind) {
    case QuestionKind::kForcedChoice:
      prompt.choices = {"the first one", "the second one"};
      break;
    case QuestionKind::kVisualAnalogue:
      prompt.is_scale = prompt.needs_enter = true;
      break;
    case QuestionKind::kLikert:
      for (std::size_t i = 1; i <= question.steps; ++i)
        prompt.choices.push_back(i == 1 ? question.low : i == question.steps ? question.high : "");
      break;
  }
  return prompt;
}

double readAnswer(const Question& question, const StudyInput& input) {
  if (question.kind == QuestionKind::kVisualAnalogue) return std::round(input.scale);
  return static_cast<double>(input.choice.value_or(0) + 1);
}

}  // namespace

bool askConsent(const Study& study, TrialPlayer& player) {
  StudyPrompt prompt{.text = study.consent, .choices = {"I agree", "I do not take part"}};
  const auto input = player.ask(prompt);
  if (input && input->choice.value_or(0) == 0) return true;
  if (!player.ended()) spdlog::info("the subject did not agree: no data was stored");
  return false;
}

std::optional<StudyInput> StudyTrials::ask(const StudyPrompt& prompt) {
  if (!parts_.observer) return parts_.player.ask(prompt);
  if (parts_.player.ended()) return std::nullopt;
  return StudyInput{.confirmed = true};
}

bool StudyTrials::run() {
  if (!parts_.observer) parts_.player.rearm();  // the consent confirms an auto-detected device, too
  while (const auto trial = parts_.schedule.findTrial()) {
    is_void_ = false;
    TrialEnd end = TrialEnd::kComplete;
    if (prepare(*trial)) end = runTrial(*trial);
    if (end == TrialEnd::kComplete) end = parts_.player.findInterruption();
    if (end == TrialEnd::kEnded || !recover(end) || !restDevice()) return false;
  }
  parts_.on_event("study end");
  (void)ask({.text = "That was the last trial. Thank you.", .needs_enter = true});
  return true;
}

/// Asks the subject to begin. Returns false if the subject stops the force or the program ends.
bool StudyTrials::prepare(const Trial& trial) {
  if (parts_.player.findInterruption() != TrialEnd::kComplete) return false;
  const std::size_t rest_every = parts_.study.rest_every;
  if (rest_every > 0 && since_rest_ >= rest_every) {
    since_rest_ = 0;
    if (!ask({.text = "Pause. Rest your hand as long as you like.", .needs_enter = true}))
      return false;
  }
  const std::size_t total = trial.number + parts_.schedule.countRemaining() - 1;
  const char* const kind = trial.is_training ? "Training, trial" : "Trial";
  const char* const intervals = parts_.study.comparison
                                    ? " You touch twice: one beep, then two beeps. Lift your hand "
                                      "between the two."
                                    : " Lift your hand before you begin.";
  spdlog::info("trial {} of {}: condition {}", trial.number, total,
               parts_.schedule.code(trial.condition));
  return ask({.text = fmt::format("{} {} of {}.{}", kind, trial.number, total, intervals),
              .needs_enter = true})
      .has_value();
}

TrialEnd StudyTrials::runTrial(const Trial& trial) {
  TrialRow row{.is_training = trial.is_training,
               .trial = trial.number,
               .condition = parts_.schedule.code(trial.condition),
               .level = trial.level};
  row.onset_s = parts_.player.now_s();  // of a trial without an interval
  row.wall_clock = formatIso8601(std::chrono::system_clock::now());
  if (trial.level) row.comparison_interval = trial.comparison_first ? 1 : 2;
  TrialEnd end = playIntervals(trial, row);
  if (end == TrialEnd::kComplete) end = askQuestion(trial, row);
  if (end == TrialEnd::kEnded) return end;  // without a row: it comes first after --resume
  row.status = toStatus(end);
  row.duration_s = parts_.player.now_s() - row.onset_s;
  parts_.events.append(row);
  parts_.on_event(fmt::format("trial {} end {}", trial.number, row.status));
  ++since_rest_;
  if (row.answer)
    parts_.schedule.onAnswer(row.is_correct.value_or(true));
  else
    parts_.schedule.onVoid();
  is_void_ = !row.answer;
  return end;
}

/// Announces an interval to the subject by its number of beeps. Returns false if the subject stops
/// the force or the program ends.
bool StudyTrials::announce(int interval) {
  if (interval == 2 && !parts_.player.wait(kBetweenIntervals_s)) return false;
  return parts_.player.beep(interval);
}

TrialEnd StudyTrials::playIntervals(const Trial& trial, TrialRow& row) {
  const Condition& condition = parts_.study.conditions[trial.condition];
  const int intervals = trial.level ? 2 : 1;
  for (int interval = 1; interval <= intervals; ++interval) {
    Condition played = condition;
    if (trial.level) {
      const Comparison& comparison = *parts_.study.comparison;
      const bool is_larger = (interval == 1) == trial.comparison_first;
      played = withVariable(condition, comparison.variable,
                            comparison.reference + (is_larger ? *trial.level : 0.0));
    }
    if (!parts_.observer && !announce(interval))
      return parts_.player.ended() ? TrialEnd::kEnded : TrialEnd::kStopped;
    parts_.on_event(
        fmt::format("trial {} interval {} condition {}", trial.number, interval, row.condition));
    const TrialEnd end =
        parts_.player.play(played, 2 * trial.number + static_cast<std::size_t>(interval));
    if (interval == 1) {
      row.onset_s = parts_.player.onset_s();
      row.wall_clock = formatIso8601(parts_.player.onsetWall());
    }
    if (end != TrialEnd::kComplete) return end;
  }
  return TrialEnd::kComplete;
}

TrialEnd StudyTrials::askQuestion(const Trial& trial, TrialRow& row) {
  const Question& question = parts_.study.question;
  const double asked_s = parts_.player.now_s();
  parts_.on_event(fmt::format("trial {} question", trial.number));
  const auto input = ask(makeQuestionPrompt(question));
  if (!input) return parts_.player.ended() ? TrialEnd::kEnded : TrialEnd::kStopped;
  row.answer =
      parts_.observer ? parts_.observer->answer(question, trial) : readAnswer(question, *input);
  row.response_time_s = parts_.player.now_s() - asked_s;
  if (trial.level) row.is_correct = *row.answer == static_cast<double>(*row.comparison_interval);
  return TrialEnd::kComplete;
}

/// After an interruption: goes on when the subject wants. Returns false if the study ends.
bool StudyTrials::recover(TrialEnd end) {
  if (end == TrialEnd::kComplete) return true;
  // An observer gives no consent to go on, except after a lost device that answers again.
  if (parts_.observer && end != TrialEnd::kDeviceLost) return false;
  std::string text = describeInterruption(end);
  if (is_void_) text += " The trial comes again at the end.";
  while (true) {
    parts_.player.clearStop();
    const auto input = ask({.text = text, .choices = {"go on", "end the study"}});
    if (parts_.player.ended() || (input && input->choice.value_or(0) != 0)) return false;
    if (!input) continue;  // Esc again: the force is off
    if (parts_.player.waitForDevice()) break;
    if (parts_.observer) return false;
    if (!parts_.player.stopped()) text = "The device still does not answer.";
  }
  parts_.player.rearm();
  return true;
}

/// Waits until the motors of the device are cool, if they were warm. Returns false if the program
/// ends.
bool StudyTrials::restDevice() {
  if (!parts_.player.takeWarm()) return true;
  const double rest_s = kRestInTimeConstants * parts_.player.desk().local().profile.thermal_s;
  spdlog::info("the motors are warm: the device rests for {:.0f} s", rest_s);
  const double end_s = parts_.player.now_s() + rest_s;
  is_void_ = false;
  while (parts_.player.now_s() < end_s) {
    const double left_s = end_s - parts_.player.now_s();
    const std::string text = fmt::format("The device rests for {:.0f} s. Rest, too.", left_s);
    if (!parts_.player.wait(left_s, {.text = text}) && !recover(parts_.player.findInterruption()))
      return false;
  }
  return true;
}

}  // namespace hapticast::client
