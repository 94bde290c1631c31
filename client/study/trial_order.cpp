// SPDX-License-Identifier: MIT
#include "client/study/trial_order.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "client/study/shuffle.hpp"

namespace hapticast::client {

namespace {

std::vector<std::size_t> listConditions(std::size_t count) {
  std::vector<std::size_t> conditions(count);
  std::iota(conditions.begin(), conditions.end(), std::size_t{0});
  return conditions;
}

/// Returns row `row` of the balanced square. The first row is 0, 1, n - 1, 2, n - 2, ...; each
/// further row adds 1 (modulo n).
std::vector<std::size_t> makeRow(std::size_t count, std::uint64_t row) {
  std::vector<std::size_t> conditions;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first_row = i % 2 == 1 ? (i + 1) / 2 : (count - i / 2) % count;
    conditions.push_back((first_row + row) % count);
  }
  const bool is_second_square = count % 2 == 1 && (row / count) % 2 == 1;
  if (is_second_square) std::reverse(conditions.begin(), conditions.end());
  return conditions;
}

}  // namespace

std::vector<std::size_t> makeTrialOrder(const TrialPlan& plan) {
  std::vector<std::size_t> order;
  const bool is_square = plan.order == TrialOrder::kLatinSquare;
  // The subjects of a square share the names of its conditions. Random orders differ by subject.
  std::seed_seq seeds{plan.seed, plan.seed >> 32, is_square ? 0 : plan.subject,
                      is_square ? 0 : plan.subject >> 32};
  std::mt19937_64 random(seeds);
  std::vector<std::size_t> names = listConditions(plan.conditions);
  if (is_square) shuffle(names, random);
  for (std::size_t block = 0; block < plan.blocks; ++block) {
    if (is_square) {
      for (const std::size_t place : makeRow(plan.conditions, plan.subject + block))
        order.push_back(names[place]);
    } else {
      shuffle(names, random);
      order.insert(order.end(), names.begin(), names.end());
    }
  }
  return order;
}

}  // namespace hapticast::client
