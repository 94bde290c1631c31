// SPDX-License-Identifier: MIT
#include "client/study/study.hpp"

#include <algorithm>
#include <cctype>

namespace hapticast::client {

double Comparison::findLargestLevel() const {
  return levels.empty() ? range.most : *std::max_element(levels.begin(), levels.end());
}

bool isLabel(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char c) { return std::isalnum(c) != 0; });
}

Condition withVariable(Condition condition, Variable variable, double value) {
  switch (variable) {
    case Variable::kStiffness:
      condition.stiffness = value;
      break;
    case Variable::kMass:
      condition.mass_kg = value;
      break;
    case Variable::kDelay:
      condition.delay_ms = value;
      break;
  }
  return condition;
}

}  // namespace hapticast::client
