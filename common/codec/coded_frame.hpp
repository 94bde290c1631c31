// SPDX-License-Identifier: MIT
// Coded frame: a frame in the form that travels to clients. Its reliefs are slices of the height
// codec. Thread: any; at most one at a time for each FrameCoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/codec/height_codec.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast {

/// A relief in coded form. `slices` has the slices that are present, which do not overlap. On the
/// receiver, some slices of the relief may be missing.
struct CodedRelief {
  PixelRect rect;  ///< inside the picture
  std::vector<SliceBytes> slices;
  std::size_t slice_count = 0;  ///< number of slices of the whole relief, at least 1

  /// Returns true if all slices of the relief are present.
  [[nodiscard]] bool whole() const { return slices.size() == slice_count; }
  /// Returns the number of bytes of all present slices.
  [[nodiscard]] std::size_t bytes() const;
  bool operator==(const CodedRelief&) const = default;
};

using CodedObject = ObjectOf<CodedRelief>;
using CodedFrame = FrameOf<CodedRelief>;

/// Returns a copy of the object `from` that has `relief` in place of its own relief.
template <class To, class From>
ObjectOf<To> replaceRelief(const ObjectOf<From>& from, std::shared_ptr<const To> relief) {
  return {from.id,     from.layer, from.changed_in_frame, std::move(relief),
          from.motion, from.grid,  from.impacts,          from.material};
}

/// Codes the frames of a stream. It reuses the coded form of a relief that did not change since the
/// previous frame.
class FrameCoder {
 public:
  /// Returns `frame` with coded reliefs. An object whose mask is empty has no relief in the result.
  /// Requires masks and heights of the size of their rectangle, at most 1920 x 1080 px.
  [[nodiscard]] CodedFrame code(const HapticFrame& frame, const SliceSettings& settings = {});

 private:
  struct Known {
    std::shared_ptr<const Relief> relief;
    SliceSettings settings;
    std::shared_ptr<const CodedRelief> coded;
  };
  std::shared_ptr<const CodedRelief> codeRelief(const Relief& relief,
                                                const SliceSettings& settings);

  HeightEncoder encoder_;
  std::map<ObjectKey, Known> known_;  // reliefs of the frame before
};

}  // namespace hapticast
