// SPDX-License-Identifier: MIT
// The trials of a subject: the same for the same seed, each of them once, whatever is void and
// wherever a run is interrupted.
#include "client/study/trial_schedule.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "client/study/events_file.hpp"
#include "client/study/simulated_observer.hpp"

namespace hapticast::client {
namespace {

Study makeStudy(SelectorKind selector) {
  Study study;
  study.name = "test";
  study.seed = 11;
  study.blocks = 20;
  study.training = 3;
  study.question.kind = QuestionKind::kForcedChoice;
  study.comparison = Comparison{.range = {0.01, 1.0}, .levels = {}};
  study.comparison->selector = selector;
  study.comparison->levels = {0.1, 0.2, 0.4};
  study.comparison->start = 0.8;
  for (const char* name : {"one", "two", "three"}) {
    study.conditions.emplace_back();
    study.conditions.back().name = name;
  }
  return study;
}

struct Ended {
  Trial trial;
  bool is_void;
};

/// Ends the present trial as an observer does. Some trials are void, by the number of the trial.
Ended endTrial(TrialSchedule& schedule, const Study& study, const SimulatedObserver& observer) {
  const Trial trial = *schedule.findTrial();
  const bool is_void = trial.number % 7 == 3 && trial.number < 60;
  if (is_void) {
    schedule.onVoid();
  } else {
    const bool first = observer.answer(study.question, trial) == 1.0;
    schedule.onAnswer(first == trial.comparison_first);
  }
  return {trial, is_void};
}

TEST(TrialSchedule, GivesEachConditionItsTrialsDespiteVoidOnes) {
  for (const SelectorKind selector :
       {SelectorKind::kConstantStimuli, SelectorKind::kStaircase, SelectorKind::kQuest}) {
    const Study study = makeStudy(selector);
    const SimulatedObserver observer({.threshold = 0.2}, 5);
    TrialSchedule schedule(study, "07");
    std::map<std::size_t, std::size_t> valid;
    std::size_t training = 0;
    bool main_began = false;
    for (std::size_t number = 1; schedule.findTrial(); ++number) {
      const Ended ended = endTrial(schedule, study, observer);
      EXPECT_EQ(ended.trial.number, number);
      EXPECT_FALSE(main_began && ended.trial.is_training);
      main_began = main_began || !ended.trial.is_training;
      if (ended.is_void) continue;
      ++(ended.trial.is_training ? training : valid[ended.trial.condition]);
    }
    EXPECT_EQ(training, 3U);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(valid[i], 20U);
  }
}

TEST(TrialSchedule, AnInterruptedRunContinuesWithTheSameTrials) {
  const Study study = makeStudy(SelectorKind::kQuest);
  const SimulatedObserver observer({.threshold = 0.2}, 5);
  std::vector<Ended> all;
  TrialSchedule whole(study, "07");
  while (whole.findTrial()) all.push_back(endTrial(whole, study, observer));
  std::mt19937 random(20261129);
  for (int run = 0; run < 50; ++run) {
    TrialSchedule again(study, "07");
    const std::size_t until = random() % all.size();
    for (std::size_t i = 0; i < until; ++i) {
      EXPECT_EQ(again.findTrial(), all[i].trial);
      (void)endTrial(again, study, observer);
    }
    TrialSchedule resumed(study, "07");
    for (std::size_t i = 0; i < until; ++i) (void)endTrial(resumed, study, observer);
    ASSERT_EQ(resumed.findTrial(), again.findTrial());
  }
}

TEST(TrialSchedule, SubjectsDifferInOrderAndInCodes) {
  Study study = makeStudy(SelectorKind::kQuest);
  std::set<std::string> codes;
  std::set<std::size_t> first;
  study.training = 0;
  for (int subject = 1; subject <= 30; ++subject) {
    const TrialSchedule schedule(study, std::to_string(subject));
    codes.insert(schedule.code(0));
    first.insert(schedule.findTrial()->condition);
    EXPECT_EQ((std::set<std::string>{schedule.code(0), schedule.code(1), schedule.code(2)}),
              (std::set<std::string>{"A", "B", "C"}));
  }
  EXPECT_EQ(codes.size(), 3U);
  EXPECT_EQ(first.size(), 3U);
}

TEST(TrialSchedule, TheLargerIntervalIsFirstInHalfOfTheTrials) {
  Study study = makeStudy(SelectorKind::kConstantStimuli);
  study.blocks = 400;
  TrialSchedule schedule(study, "x");
  int first = 0;
  for (; schedule.findTrial(); schedule.onAnswer(true))
    first += schedule.findTrial()->comparison_first ? 1 : 0;
  EXPECT_NEAR(first, 600, 60);  // of 1203; 3.5 standard deviations
}

TEST(TrialSchedule, MoreThan26ConditionsHaveDifferentCodes) {
  Study study = makeStudy(SelectorKind::kQuest);
  study.conditions.resize(100);
  const TrialSchedule schedule(study, "1");
  std::set<std::string> codes;
  for (std::size_t i = 0; i < 100; ++i) codes.insert(schedule.code(i));
  EXPECT_EQ(codes.size(), 100U);
}

TEST(SimulatedObserver, ReadsItsFunction) {
  const auto function = parseObserver("threshold=0.3,slope=2,lapse=0");
  ASSERT_TRUE(function);
  EXPECT_EQ(function->threshold, 0.3);
  EXPECT_EQ(function->slope, 2.0);
  for (const char* wrong : {"", "slope=2", "threshold=0", "threshold=x", "threshold", "lapse=0.1",
                            "threshold=1,slope=99", "threshold=1,lapse=0.6", "threshold=1;x=1"})
    EXPECT_FALSE(parseObserver(wrong)) << wrong;
}

TEST(SimulatedObserver, AnswersByItsFunctionAndWithinTheScale) {
  const SimulatedObserver observer({.threshold = 0.2, .slope = 2.0, .lapse = 0.02}, 7);
  Question question;
  question.kind = QuestionKind::kForcedChoice;
  int correct = 0;
  for (std::size_t number = 1; number <= 4000; ++number) {
    const Trial trial{.number = number, .level = 0.2, .comparison_first = number % 2 == 0};
    correct += observer.answer(question, trial) == (trial.comparison_first ? 1.0 : 2.0) ? 1 : 0;
  }
  EXPECT_NEAR(correct / 4000.0, 0.74, 0.025);
  question.kind = QuestionKind::kLikert;
  std::set<double> answers;
  for (std::size_t number = 1; number <= 300; ++number)
    answers.insert(observer.answer(question, {.number = number}));
  EXPECT_EQ(answers, (std::set<double>{1, 2, 3, 4, 5, 6, 7}));
}

}  // namespace
}  // namespace hapticast::client
