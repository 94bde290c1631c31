// SPDX-License-Identifier: MIT
#include "client/study/trial_schedule.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "client/study/shuffle.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

// Distinguish the random numbers of a study, which all come from its seed.
enum class Draw : std::uint8_t { kCode = 1, kSelector, kInterval, kTraining };

std::mt19937_64 makeRandom(const Study& study, std::uint64_t subject, Draw draw,
                           std::size_t number) {
  const auto low = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
  const auto high = [](std::uint64_t value) { return static_cast<std::uint32_t>(value >> 32U); };
  std::seed_seq seed{low(study.seed),
                     high(study.seed),
                     low(subject),
                     high(subject),
                     static_cast<std::uint32_t>(draw),
                     low(number)};
  return std::mt19937_64(seed);
}

std::string toLetters(std::size_t number) {
  std::string letters(1, static_cast<char>('A' + number % 26));
  if (number >= 26) letters.insert(letters.begin(), static_cast<char>('A' + number / 26 - 1));
  return letters;
}

PsychometricFunction assumeFunction(const Comparison& comparison) {
  return {.threshold = 1.0, .slope = 2.0, .guess = 0.5, .lapse = comparison.lapse};
}

std::unique_ptr<LevelSelector> makeSelector(const Comparison& comparison, std::uint64_t seed) {
  switch (comparison.selector) {
    case SelectorKind::kConstantStimuli:
      return makeConstantStimuli(comparison.levels, seed);
    case SelectorKind::kStaircase:
      return makeStaircase({.range = comparison.range,
                            .start = comparison.start,
                            .up = comparison.up,
                            .down = comparison.down,
                            .factor = comparison.factor});
    case SelectorKind::kQuest:
      break;
  }
  return makeQuest(comparison.range, assumeFunction(comparison));
}

}  // namespace

std::uint64_t toSubjectNumber(std::string_view subject) {
  if (const auto number =
          parseNumberInRange<std::uint64_t>(subject, 0, std::numeric_limits<std::uint64_t>::max()))
    return *number;
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : subject) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

TrialSchedule::TrialSchedule(const Study& study, std::string_view subject)
    : study_(study), subject_(toSubjectNumber(subject)) {
  const std::size_t conditions = study.conditions.size();
  std::vector<std::size_t> letters(conditions);
  std::iota(letters.begin(), letters.end(), std::size_t{0});
  std::vector<std::size_t> training = letters;  // not in the order of the file, which has names
  auto training_random = makeRandom(study, subject_, Draw::kTraining, 0);
  shuffle(training, training_random);
  for (std::size_t i = 0; i < study.training; ++i)
    waiting_.push_back({training[i % conditions], true});
  for (const std::size_t each : makeTrialOrder({.order = study.order,
                                .conditions = conditions,
                                .blocks = study.blocks,
                                .seed = study.seed,
                                .subject = subject_}))
    waiting_.push_back({each, false});
  auto random = makeRandom(study, subject_, Draw::kCode, 0);
  shuffle(letters, random);
  for (const std::size_t each : letters) codes_.push_back(toLetters(each));
  if (!study.comparison) return;
  for (std::size_t i = 0; i < conditions; ++i) {
    const std::uint64_t seed = makeRandom(study, subject_, Draw::kSelector, i)();
    thresholds_.push_back({makeSelector(*study.comparison, seed),
                           {study.comparison->range, assumeFunction(*study.comparison)}});
  }
}

std::optional<Trial> TrialSchedule::findTrial() const {
  if (waiting_.empty()) return std::nullopt;
  const Waiting& now = waiting_.front();
  Trial trial{.number = number_, .is_training = now.is_training, .condition = now.condition};
  if (!study_.comparison) return trial;
  trial.level = now.is_training ? study_.comparison->findLargestLevel()  // the easiest
                                : thresholds_[now.condition].selector->selectLevel();
  trial.comparison_first = makeRandom(study_, subject_, Draw::kInterval, number_)() % 2 == 0;
  return trial;
}

void TrialSchedule::onAnswer(bool is_correct) {
  const Waiting now = waiting_.front();
  if (study_.comparison && !now.is_training) {
    Threshold& threshold = thresholds_[now.condition];
    threshold.posterior.update({threshold.selector->selectLevel(), is_correct});
    threshold.selector->onAnswer(is_correct);
  }
  end();
}

void TrialSchedule::onVoid() {
  const Waiting now = waiting_.front();
  end();
  const auto first_main = std::find_if(waiting_.begin(), waiting_.end(),
                                       [](const Waiting& each) { return !each.is_training; });
  waiting_.insert(now.is_training ? first_main : waiting_.end(), now);
}

void TrialSchedule::end() {
  waiting_.pop_front();
  ++number_;
}

}  // namespace hapticast::client
