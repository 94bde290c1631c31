// SPDX-License-Identifier: MIT
// Terms and rules of the segmentation that the evaluation leaves out one by one (ablation), to
// measure what each of them is worth. The product leaves out none. Thread: change them only while
// no Vision runs.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>

namespace hapticast::server {

/// A term of the objectness score, or a rule of the start or of the tracking.
enum class Rule : std::size_t {
  kApart,
  kEdge,
  kContact,
  kStray,
  kSkin,
  kSmall,
  kColorSeparates,
  kComponent,
  kHandIsWhole,
  kBodyIsWhole,
  kSettledCut,
  kHandMixture,
  kHole,
  kValley,
  kOccludedParts,
  kShape,
  kDeadReckoning,
  kRestingPlace,
  kBox,
  kHandColors,
  kDetachedPieces,
  kLeftBehind,
  kElsewhere,
  kLean,
  kCount
};

/// Names of the rules, in their order.
inline constexpr std::array<const char*, static_cast<std::size_t>(Rule::kCount)> kRuleNames{
    "term apart",
    "term edge",
    "term contact",
    "term stray",
    "term skin",
    "term small",
    "contact: a colour edge separates",
    "start: component of depth, cut by colour",
    "start: a hand is meant whole",
    "start: a body is meant whole",
    "start: steps of the band settle a cut",
    "start: the hand's own colours",
    "start: evidence of holes",
    "cut: valleys",
    "cut: parts behind a finger",
    "track: the object's own shape",
    "track: dead reckoning",
    "track: the resting place",
    "track: the correlation filter's box",
    "track: the hand's own colours",
    "track: detached pieces",
    "track: left behind",
    "track: colours elsewhere",
    "track: lean of the contour",
};

static_assert(kRuleNames.back() != nullptr, "each rule has a name");

/// Rules that are left out. Only the evaluation sets them.
inline std::bitset<static_cast<std::size_t>(Rule::kCount)> rules_left_out;

/// Returns whether the segmentation uses `rule`.
inline bool usesRule(Rule rule) { return !rules_left_out[static_cast<std::size_t>(rule)]; }

}  // namespace hapticast::server
