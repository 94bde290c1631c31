// SPDX-License-Identifier: MIT
// Converts frames of the library (hapticast/frame.hpp) to those of the programs, and checks them
// with the limits of the wire. Thread: at most one at a time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "common/haptic_frame.hpp"
#include "common/include/hapticast/frame.hpp"

namespace hapticast {

/// Returns the description that `info` states. Throws std::invalid_argument if a value is outside
/// its range.
[[nodiscard]] StreamDescription importInfo(const StreamInfo& info);

/// Returns the material that `material` states. Throws std::invalid_argument if a value is outside
/// its range.
[[nodiscard]] Material importMaterial(const Object::Material& material);

/// Converts the frames of one stream, in their order. An object whose HeightMap is that of the
/// frame before has the Relief of the frame before.
class FrameImporter {
 public:
  /// `info` is that of the stream. Throws like importInfo().
  explicit FrameImporter(const StreamInfo& info) : description_(importInfo(info)) {}

  /// Returns `frame` with the number `id` and the time of `frame`. Throws std::invalid_argument if
  /// a value is outside its range or sizes do not match; the importer then has not changed.
  [[nodiscard]] HapticFrame import(const Frame& frame, std::uint64_t id);
  /// The same with the time `media_time` in place of the time of `frame`. Its impacts keep their
  /// distance to the time of the frame.
  [[nodiscard]] HapticFrame import(const Frame& frame, std::uint64_t id, MediaTime media_time);
  [[nodiscard]] const StreamDescription& description() const { return description_; }

 private:
  struct Known {
    std::shared_ptr<const HeightMap> from;
    std::shared_ptr<const Relief> relief;
    std::uint64_t changed_in_frame = 0;
  };
  StreamDescription description_;
  std::map<ObjectKey, Known> known_;  // of the frame before
};

}  // namespace hapticast
