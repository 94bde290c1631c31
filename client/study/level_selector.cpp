// SPDX-License-Identifier: MIT
#include "client/study/level_selector.hpp"

#include <algorithm>
#include <cstddef>
#include <random>
#include <stdexcept>
#include <utility>

#include "client/study/shuffle.hpp"

namespace hapticast::client {

namespace {

class ConstantStimuli : public LevelSelector {
 public:
  ConstantStimuli(std::vector<double> levels, std::uint64_t seed)
      : levels_(std::move(levels)), random_(seed) {
    if (levels_.empty()) throw std::invalid_argument("constant stimuli need at least one level");
    shuffle(levels_, random_);
  }
  [[nodiscard]] double selectLevel() const override { return levels_[at_]; }
  void onAnswer(bool /*is_correct*/) override {
    if (++at_ < levels_.size()) return;
    at_ = 0;
    shuffle(levels_, random_);
  }

 private:
  std::vector<double> levels_;
  std::mt19937_64 random_;
  std::size_t at_ = 0;
};

class Staircase : public LevelSelector {
 public:
  explicit Staircase(const StaircaseSettings& settings)
      : settings_(settings), level_(settings.start) {
    const LevelRange& range = settings.range;
    range.requireValid();
    const bool valid = settings.start >= range.least && settings.start <= range.most &&
                       settings.up >= 1 && settings.down >= 1 && settings.factor > 1.0;
    if (!valid)
      throw std::invalid_argument(
          "a staircase needs least <= start <= most, up and down of 1 or more, and a factor above "
          "1");
  }
  [[nodiscard]] double selectLevel() const override { return level_; }
  void onAnswer(bool is_correct) override {
    correct_ = is_correct ? correct_ + 1 : 0;
    wrong_ = is_correct ? 0 : wrong_ + 1;
    if (correct_ == settings_.down) move(1.0 / settings_.factor);
    if (wrong_ == settings_.up) move(settings_.factor);
  }

 private:
  void move(double factor) {
    level_ = std::clamp(level_ * factor, settings_.range.least, settings_.range.most);
    correct_ = wrong_ = 0;
  }

  StaircaseSettings settings_;
  double level_;
  int correct_ = 0;  // in a row, at this level
  int wrong_ = 0;
};

class Quest : public LevelSelector {
 public:
  Quest(const LevelRange& range, const PsychometricFunction& assumed)
      : posterior_(range, assumed), level_(posterior_.computeMedian()) {}
  [[nodiscard]] double selectLevel() const override { return level_; }
  void onAnswer(bool is_correct) override {
    posterior_.update({.level = level_, .is_correct = is_correct});
    level_ = posterior_.computeMedian();
  }

 private:
  ThresholdPosterior posterior_;
  double level_;
};

}  // namespace

std::unique_ptr<LevelSelector> makeConstantStimuli(std::vector<double> levels, std::uint64_t seed) {
  return std::make_unique<ConstantStimuli>(std::move(levels), seed);
}

std::unique_ptr<LevelSelector> makeStaircase(const StaircaseSettings& settings) {
  return std::make_unique<Staircase>(settings);
}

std::unique_ptr<LevelSelector> makeQuest(const LevelRange& range,
                                         const PsychometricFunction& assumed) {
  return std::make_unique<Quest>(range, assumed);
}

}  // namespace hapticast::client
