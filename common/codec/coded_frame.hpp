// SPDX-License-Identifier: MIT
// A frame as it travels: its reliefs as slices of the height codec. Thread: any; a FrameCoder has
// one.
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

/// The slices of a relief, as many of them as have come: none overlaps another.
struct CodedRelief {
  PixelRect rect;  ///< inside the picture
  std::vector<SliceBytes> slices;
  std::size_t slice_count = 0;  ///< of the whole relief; a relief holds at least one

  [[nodiscard]] bool whole() const { return slices.size() == slice_count; }
  [[nodiscard]] std::size_t bytes() const;
  bool operator==(const CodedRelief&) const = default;
};

using CodedObject = ObjectOf<CodedRelief>;
using CodedFrame = FrameOf<CodedRelief>;

/// The same object with another relief.
template <class To, class From>
ObjectOf<To> withRelief(const ObjectOf<From>& from, std::shared_ptr<const To> relief) {
  return {from.id,     from.layer, from.changed_in_frame, std::move(relief),
          from.motion, from.grid,  from.impacts,          from.material};
}

/// Codes the reliefs of a stream's frames, each of them once for as long as it stays the same.
class FrameCoder {
 public:
  /// An object whose relief holds no pixel comes out without one. Requires every relief's mask and
  /// heights to have its rectangle's size, at most 1920 x 1080.
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
  std::map<ObjectKey, Known> known_;  // of the frame before
};

}  // namespace hapticast
