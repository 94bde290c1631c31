// SPDX-License-Identifier: MIT
// Cache of the stream's reliefs by object: a frame that declares a relief unchanged refers to it. A
// relief remains coded until a played frame needs it, and is then decoded and prepared once. So a
// dropped frame costs no decoding.
//
// The slices remain after the decoding: a relief that is resent without a change needs no second
// preparation, whatever frame it names as its change. Error concealment replaces lost slices by the
// previous relief.
// Thread: decode thread (one at a time).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/haptic_frame.hpp"
#include "common/relief/height_field.hpp"

namespace hapticast::client {

// Error concealment: replaces lost slices of a relief by the previous relief, moved with the
// object.
// Thread: any (pure functions).

/// A relief and the motion of its object at that time.
struct PosedRelief {
  std::shared_ptr<const Relief> relief;
  Motion motion;
};

/// Returns the rectangle of the relief after the object's motion to `now`, clipped to the picture;
/// empty outside it.
[[nodiscard]] PixelRect warpedRect(const PosedRelief& before, const Motion& now,
                                   const Workspace& workspace);

/// Fills the pixels of `to` that `have` does not mark. `have` has one byte for each pixel of
/// to.rect. The values are those of `before`, moved to the pose `now`: translated, turned about the
/// reference point, and raised.
void concealMissing(const PosedRelief& before, const Motion& now, const Workspace& workspace,
                    const std::vector<std::uint8_t>& have, Relief& to);

class ReliefCache {
 public:
  /// Result of resolve().
  struct Resolved {
    std::shared_ptr<const HeightField> field;  ///< null: nothing to touch
    bool rejected = false;                     ///< the relief does not fit the announced picture
    /// Slices that never arrived, and slices that failed to decode. Counted once for each relief.
    std::uint64_t slices_lost = 0;
    std::uint64_t slices_refused = 0;
  };

  /// Starts a new stream with an empty cache. `method` selects the preparation of heights.
  void reset(const Workspace& workspace, Method method);

  /// Clears the cache at a new epoch.
  void forget() { entries_.clear(); }
  /// Stores the relief of an object of frame `frame_id`, or its renewed use, without decoding.
  void remember(const CodedObject& object, std::uint64_t frame_id);
  /// Stores the relief and returns it as a height field. Error concealment replaces lost slices, or
  /// a relief that is completely lost, if a previous relief exists. May allocate and last
  /// milliseconds, once for each change of a relief.
  [[nodiscard]] Resolved resolve(const CodedObject& object, std::uint64_t frame_id);

  /// Number of cached objects; the least recently used one is dropped first. A returning object
  /// receives a repeated relief. Chosen: twice the objects of a frame.
  static constexpr std::size_t kMaxEntries = 2 * kMaxObjects;

 private:
  struct Entry {
    std::uint64_t changed_in_frame = 0;
    std::uint64_t used_in_frame = 0;
    std::shared_ptr<const CodedRelief> coded;
    Motion motion;       // motion of the object with this relief
    PosedRelief before;  // previously decoded relief; after decoding, this one
    bool decoded = false;
    Resolved resolved;  // valid once `decoded`
  };
  /// Error concealment of a relief that is completely lost: the previous relief replaces it.
  void concealAll(Entry& entry, const CodedObject& object) const;
  Resolved prepare(Entry& entry);
  /// Decodes the relief of an entry. Returns null if slices are missing and no previous relief
  /// exists.
  std::shared_ptr<const Relief> decode(const Entry& entry, Resolved& counts);
  [[nodiscard]] bool inPicture(const PixelRect& rect) const;
  void forgetOldest();

  Workspace workspace_;
  Method method_ = Method::kHapticast;
  HeightDecoder decoder_;
  std::map<ObjectKey, Entry> entries_;
};

}  // namespace hapticast::client
