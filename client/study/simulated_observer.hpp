// SPDX-License-Identifier: MIT
// A simulated observer (--simulate), which answers in place of a subject. In a forced choice it
// answers by a psychometric function with lapses, on a scale at random.
// Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "client/study/psychometric_function.hpp"
#include "client/study/study.hpp"
#include "client/study/trial_schedule.hpp"

namespace hapticast::client {

/// Returns the function in a text such as "threshold=0.15,slope=1.3,lapse=0.02". The threshold must
/// be there. Returns nullopt for any other text, and for values out of their ranges.
[[nodiscard]] std::optional<PsychometricFunction> parseObserver(std::string_view text);

class SimulatedObserver {
 public:
  SimulatedObserver(const PsychometricFunction& function, std::uint64_t seed)
      : function_(function), seed_(seed) {}

  /// Returns the answer to `trial`: 1 or 2 (interval) for a forced choice, 1..steps for a Likert
  /// scale, 0..100 for a visual analogue scale. The same trial always gets the same answer.
  [[nodiscard]] double answer(const Question& question, const Trial& trial) const;

 private:
  PsychometricFunction function_;
  std::uint64_t seed_;
};

}  // namespace hapticast::client
