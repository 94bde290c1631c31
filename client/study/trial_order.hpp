// SPDX-License-Identifier: MIT
// Order of the conditions of a study. Random in blocks: each block has each condition once, in a
// random order. Balanced Latin square (Williams 1949): subject s gets row s of a square in which
// each condition has each place equally often, and follows each other condition equally often. An
// odd number of conditions needs a second square, which is the first one reversed.
//
// The same arguments give the same order on every machine. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapticast::client {

enum class TrialOrder : std::uint8_t { kRandomInBlocks, kLatinSquare };

struct TrialPlan {
  TrialOrder order = TrialOrder::kRandomInBlocks;
  std::size_t conditions = 1;  ///< number of conditions, 1 or more
  std::size_t blocks = 1;      ///< how often a subject gets each condition
  std::uint64_t seed = 0;      ///< of the study: it also names the conditions of a square
  std::uint64_t subject = 0;   ///< number of the subject
};

/// Returns the condition of each trial, 0..conditions - 1, for `conditions` x `blocks` trials. In a
/// Latin square, each further block has the next row.
[[nodiscard]] std::vector<std::size_t> makeTrialOrder(const TrialPlan& plan);

}  // namespace hapticast::client
