// SPDX-License-Identifier: MIT
#include "client/study/study.hpp"

namespace hapticast::client {

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
