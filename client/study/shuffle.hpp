// SPDX-License-Identifier: MIT
// Fisher-Yates shuffle. std::shuffle gives another order with each standard library, and a study
// needs the same order on every machine.
#pragma once

#include <cstddef>
#include <random>
#include <utility>
#include <vector>

namespace hapticast::client {

/// Brings `values` into a random order.
template <class Value>
void shuffle(std::vector<Value>& values, std::mt19937_64& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random() % i]);
}

}  // namespace hapticast::client
