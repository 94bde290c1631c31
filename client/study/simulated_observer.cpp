// SPDX-License-Identifier: MIT
#include "client/study/simulated_observer.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "common/text.hpp"

namespace hapticast::client {

std::optional<PsychometricFunction> parseObserver(std::string_view text) {
  PsychometricFunction function{.threshold = 0.0, .slope = 1.3, .guess = 0.5, .lapse = 0.02};
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    const std::size_t split = part.find('=');
    if (split == std::string_view::npos) return std::nullopt;
    const auto value = parseNumber(part.substr(split + 1));
    const std::string_view key = part.substr(0, split);
    if (!value) return std::nullopt;
    if (key == "threshold")
      function.threshold = *value;
    else if (key == "slope")
      function.slope = *value;
    else if (key == "lapse")
      function.lapse = *value;
    else
      return std::nullopt;
  }
  const bool valid = function.threshold > 0.0 && function.threshold <= 1e6 &&
                     function.slope >= 0.1 && function.slope <= 20.0 && function.lapse >= 0.0 &&
                     function.lapse <= 0.5;
  return valid ? std::optional(function) : std::nullopt;
}

double SimulatedObserver::answer(const Question& question, const Trial& trial) const {
  std::seed_seq seed{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32U),
                     static_cast<std::uint32_t>(trial.number)};
  std::mt19937_64 random(seed);
  constexpr double kStep = 0x1p-53;  // of a random number with 53 bits
  const double share = static_cast<double>(random() >> 11U) * kStep;
  switch (question.kind) {
    case QuestionKind::kForcedChoice: {
      const bool is_correct = share < function_.computeCorrect(trial.level.value_or(0.0));
      return is_correct == trial.comparison_first ? 1.0 : 2.0;
    }
    case QuestionKind::kLikert:
      return 1.0 + std::floor(share * static_cast<double>(question.steps));
    case QuestionKind::kVisualAnalogue:
      break;
  }
  return std::round(100.0 * share);
}

}  // namespace hapticast::client
