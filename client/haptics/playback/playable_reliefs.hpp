// SPDX-License-Identifier: MIT
// What the loop can feel of a frame, for whoever draws it.
#pragma once

#include <memory>
#include <vector>

#include "common/relief/height_field.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Keeps nothing alive: its reliefs are there as long as the loop may play the frame.
struct PlayableReliefs {
  MediaTime media_time;
  std::vector<std::weak_ptr<const HeightField>> reliefs;  ///< of its objects
};

}  // namespace hapticast::client
