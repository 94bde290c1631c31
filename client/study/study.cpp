// SPDX-License-Identifier: MIT
#include "client/study/study.hpp"

namespace hapticast::client {

double readVariable(const Condition& condition, Variable variable) {
  switch (variable) {
    case Variable::kStiffness:
      return condition.stiffness;
    case Variable::kMass:
      return condition.mass_kg.value_or(0.0);
    case Variable::kDelay:
      return condition.delay_ms;
  }
  return 0.0;
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
