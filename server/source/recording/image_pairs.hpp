// SPDX-License-Identifier: MIT
// Pairs the images of two topics of a recording by their times. Thread: any.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/source/recording/recording_index.hpp"

namespace hapticast::server {

/// A colour image and its depth.
struct RecordedPair {
  std::uint64_t index = 0;  ///< its time at the rate of the clip, so it has gaps
  McapPlace color;
  McapPlace depth;
};

/// The frames of a recording.
struct RecordedPairs {
  std::vector<RecordedPair> pairs;  ///< in the order of time, at least one
  double fps = 25.0;                ///< frames/s
};

/// Returns the pairs of `topics`. Each colour image has the depth image that is nearest in time, at
/// most half a median step away, and no depth image is used twice. Images without a partner are
/// left out. The times are the stamps of the messages if each of them has one, else the times at
/// which the program recorded them. Logs one warning for times that run back, and one for images
/// without a partner. Throws SourceError that names `file` if there is no pair, or if the times
/// span more than a million seconds.
[[nodiscard]] RecordedPairs pairImages(const TopicPair& topics, const std::string& file);

}  // namespace hapticast::server
