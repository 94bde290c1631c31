// SPDX-License-Identifier: MIT
// The reliefs of a frame that the loop can touch, for the views.
// Thread: any.
#pragma once

#include <memory>
#include <vector>

#include "common/relief/height_field.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Weak references: a relief exists as long as the loop may play its frame.
struct PlayableReliefs {
  MediaTime media_time;
  std::vector<std::weak_ptr<const HeightField>> reliefs;  ///< one for each object
};

}  // namespace hapticast::client
