// SPDX-License-Identifier: MIT
// Psychophysical methods beside simulated observers. An observer compares two stimuli with internal
// Gaussian noise, so the fitted Weibull function is not the one that made the answers.
#include "client/study/level_selector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>

namespace hapticast::client {
namespace {

constexpr int kTrials = 60;
constexpr LevelRange kRange{.least = 0.01, .most = 1.0};
constexpr PsychometricFunction kAssumed{};
// Of a standard normal distribution: 75 % of it lie below.
constexpr double kThreeQuarters = 0.67448975;

/// Compares two stimuli that differ by a level. Its JND is the level with 75 % correct answers.
class GaussianObserver {
 public:
  GaussianObserver(double jnd, double lapse, std::uint64_t seed)
      : noise_(0.0, jnd / kThreeQuarters), lapse_(lapse), random_(seed) {}
  bool answer(double level) {
    const bool lapses = uniform_(random_) < lapse_;
    return lapses ? uniform_(random_) < 0.5 : level + noise_(random_) > 0.0;
  }

 private:
  std::normal_distribution<double> noise_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  double lapse_;
  std::mt19937_64 random_;
};

using MakeSelector = std::function<std::unique_ptr<LevelSelector>(std::uint64_t seed)>;

double estimateJnd(LevelSelector& selector, GaussianObserver& observer) {
  ThresholdPosterior posterior(kRange, kAssumed);
  for (int trial = 0; trial < kTrials; ++trial) {
    const double level = selector.selectLevel();
    const bool is_correct = observer.answer(level);
    selector.onAnswer(is_correct);
    posterior.update({.level = level, .is_correct = is_correct});
  }
  return posterior.computeMedian();
}

struct Spread {
  double lower = 0.0, median = 0.0, upper = 0.0;  // quartiles of estimate / JND
};

Spread estimateMany(const MakeSelector& make, double jnd, double lapse, int runs) {
  std::vector<double> ratios;
  for (int run = 0; run < runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const auto selector = make(seed);
    GaussianObserver observer(jnd, lapse, 7919 + seed);
    ratios.push_back(estimateJnd(*selector, observer) / jnd);
  }
  std::sort(ratios.begin(), ratios.end());
  const std::size_t quarter = ratios.size() / 4;
  return {ratios[quarter], ratios[2 * quarter], ratios[3 * quarter]};
}

std::unique_ptr<LevelSelector> quest(std::uint64_t /*seed*/) { return makeQuest(kRange, kAssumed); }

std::unique_ptr<LevelSelector> staircase(std::uint64_t /*seed*/) {
  return makeStaircase({.range = kRange, .start = 0.5});
}

TEST(LevelSelector, SixtyTrialsFindTheJndOfAnObserver) {
  const auto constant = [](std::uint64_t seed) {
    return makeConstantStimuli({0.03, 0.06, 0.12, 0.18, 0.24, 0.3}, seed);
  };
  const std::map<std::string, MakeSelector> methods = {
      {"QUEST", quest}, {"staircase", staircase}, {"constant stimuli", constant}};
  for (const auto& [name, make] : methods) {
    SCOPED_TRACE(name);
    const Spread spread = estimateMany(make, 0.12, 0.02, name == "QUEST" ? 1000 : 300);
    RecordProperty(name, std::to_string(spread.median));
    std::printf("%s: estimate / JND: median %.3f, quartiles %.3f to %.3f\n", name.c_str(),
                spread.median, spread.lower, spread.upper);
    EXPECT_NEAR(spread.median, 1.0, 0.05);
    EXPECT_GT(spread.lower, 0.7);
    EXPECT_LT(spread.upper, 1.4);
  }
}

TEST(LevelSelector, QuestFindsSmallAndLargeJnds) {
  for (const double jnd : {0.04, 0.3}) {
    const Spread spread = estimateMany(quest, jnd, 0.04, 300);
    EXPECT_NEAR(spread.median, 1.0, 0.08) << jnd;
  }
}

TEST(LevelSelector, ConstantStimuliHaveEachLevelOnceInABlock) {
  const std::vector<double> levels{1.0, 2.0, 3.0, 4.0, 5.0};
  const auto selector = makeConstantStimuli(levels, 3);
  const auto same = makeConstantStimuli(levels, 3);
  std::vector<std::vector<double>> blocks;
  for (int block = 0; block < 20; ++block) {
    std::vector<double> shown;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      shown.push_back(selector->selectLevel());
      EXPECT_EQ(same->selectLevel(), shown.back()) << "the same seed has the same order";
      selector->onAnswer(true);
      same->onAnswer(false);
    }
    blocks.push_back(shown);
    std::sort(shown.begin(), shown.end());
    EXPECT_EQ(shown, levels);
  }
  EXPECT_NE(blocks[0], blocks[1]);
}

TEST(LevelSelector, AStaircaseMovesAfterAnswersInARowAndStaysInItsRange) {
  const auto selector =
      makeStaircase({.range = {1.0, 8.0}, .start = 4.0, .up = 1, .down = 2, .factor = 2.0});
  selector->onAnswer(true);
  EXPECT_EQ(selector->selectLevel(), 4.0);
  selector->onAnswer(true);
  EXPECT_EQ(selector->selectLevel(), 2.0);
  selector->onAnswer(true);
  selector->onAnswer(false);
  EXPECT_EQ(selector->selectLevel(), 4.0);
  for (int i = 0; i < 5; ++i) selector->onAnswer(false);
  EXPECT_EQ(selector->selectLevel(), 8.0);
  for (int i = 0; i < 20; ++i) selector->onAnswer(true);
  EXPECT_EQ(selector->selectLevel(), 1.0);
}

TEST(LevelSelector, AContradictorySubjectLeavesAFiniteEstimate) {
  ThresholdPosterior posterior(kRange, {.guess = 0.5, .lapse = 0.0});
  for (int i = 0; i < 500; ++i)
    posterior.update({.level = i % 2 == 0 ? 1e9 : 0.0, .is_correct = i % 3 == 0});
  EXPECT_GE(posterior.computeMedian(), 0.9 * kRange.least);
  EXPECT_LE(posterior.computeMedian(), 1.1 * kRange.most);
  EXPECT_LE(posterior.computeQuantile(0.25), posterior.computeQuantile(0.75));
}

TEST(LevelSelector, SettingsOutOfRangeAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)makeConstantStimuli({}, 1), std::invalid_argument);
  for (const LevelRange& range :
       {LevelRange{0.0, 1.0}, {1.0, 1.0}, {kNan, 1.0}, {0.1, kNan}, {0.1, INFINITY}}) {
    EXPECT_THROW((void)makeQuest(range, kAssumed), std::invalid_argument);
    EXPECT_THROW((void)makeStaircase({.range = range, .start = 0.5}), std::invalid_argument);
  }
  EXPECT_THROW((void)makeStaircase({.range = kRange, .start = 2.0}), std::invalid_argument);
  EXPECT_THROW((void)makeStaircase({.range = kRange, .start = 0.5, .up = 0}),
               std::invalid_argument);
  EXPECT_THROW((void)makeStaircase({.range = kRange, .start = 0.5, .factor = kNan}),
               std::invalid_argument);
}

}  // namespace
}  // namespace hapticast::client
