// SPDX-License-Identifier: MIT
// Cache of the stream's reliefs, one for each object. If a frame declares a relief unchanged, the
// client uses the relief in the cache. The cache stores a relief in coded form until a played frame
// needs it. Then it decodes and prepares the relief once. So a dropped frame costs no decoding.
//
// The slices remain in the cache after the decoding. So if the server sends the same relief again,
// the client does not prepare it a second time. Error concealment replaces lost slices by the
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

/// A relief, and the motion of its object in the frame of the relief. Error concealment moves it
/// with the object, and uses it in place of lost slices of the next relief. Thread: any.
struct PosedRelief {
  std::shared_ptr<const Relief> relief;
  Motion motion;
};

/// Returns the rectangle of the relief of `before` after its object has moved to the pose of `now`.
/// It is the smallest rectangle of pixels around the moved relief, clipped to the picture. It is
/// empty if the relief has moved out of the picture.
[[nodiscard]] PixelRect warpRect(const PosedRelief& before, const Motion& now,
                                 const Workspace& workspace);

/// Fills the missing pixels of the relief `to` with those of the relief in `before`. `have` has one
/// byte for each pixel of to.rect, and 0 marks a missing pixel. The object's motion from `before`
/// to `now` moves the pixels: they are translated, turned about the reference point, and raised.
void concealMissing(const PosedRelief& before, const Motion& now, const Workspace& workspace,
                    const std::vector<std::uint8_t>& have, Relief& to);

/// The cache of one stream.
class ReliefCache {
 public:
  /// Result of resolve().
  struct Resolved {
    /// Null if the object has no relief that can be touched, or if the cache prepares no fields.
    std::shared_ptr<const HeightField> field;
    std::shared_ptr<const Relief> relief;  ///< the decoded relief; null if it cannot be touched
    bool rejected = false;  ///< the relief does not fit the stream's picture, or it is too high
    /// Number of slices that never arrived, and of slices that could not be decoded. Each relief is
    /// counted only once.
    std::uint64_t slices_lost = 0;
    std::uint64_t slices_refused = 0;
  };

  /// `prepares_fields`: false if the caller needs the decoded reliefs only, which saves most of the
  /// time of resolve().
  explicit ReliefCache(bool prepares_fields = true) : prepares_fields_(prepares_fields) {}

  /// Prepares for a new stream: empties the cache. `method` selects how heights are prepared.
  void reset(const Workspace& workspace, Method method);

  /// Empties the cache. Call it at a new epoch.
  void forget() { entries_.clear(); }
  /// Stores the relief of `object` without decoding it. If frame `frame_id` declares the relief
  /// unchanged, the call only registers that it is still in use.
  void remember(const CodedObject& object, std::uint64_t frame_id);
  /// Stores the relief of `object`, and returns it as a height field. If slices or the whole relief
  /// are lost, error concealment uses the previous relief, if there is one. The call may allocate,
  /// and it lasts milliseconds once for each change of a relief.
  [[nodiscard]] Resolved resolve(const CodedObject& object, std::uint64_t frame_id);

  /// Largest number of cached objects. Above it, the cache drops the least recently used object. If
  /// that object returns, the server sends its relief again. The value is a choice: twice the
  /// objects of a frame.
  static constexpr std::size_t kMaxEntries = 2 * kMaxObjects;

 private:
  struct Entry {
    std::uint64_t changed_in_frame = 0;
    std::uint64_t used_in_frame = 0;
    std::shared_ptr<const CodedRelief> coded;
    Motion motion;  // motion of the object in the frame of this relief
    // The relief that was decoded last, which is this one once `decoded` is true.
    PosedRelief before;
    bool decoded = false;
    Resolved resolved;  // valid once `decoded`
  };
  /// Replaces a relief that is completely lost by the previous relief.
  void concealAll(Entry& entry, const CodedObject& object) const;
  Resolved prepare(Entry& entry);
  /// Decodes the relief of an entry. Returns null if slices are missing and there is no previous
  /// relief.
  std::shared_ptr<const Relief> decode(const Entry& entry, Resolved& counts);
  [[nodiscard]] bool isInPicture(const PixelRect& rect) const;
  void forgetOldest();

  bool prepares_fields_;
  Workspace workspace_;
  Method method_ = Method::kHapticast;
  HeightDecoder decoder_;
  std::map<ObjectKey, Entry> entries_;
};

}  // namespace hapticast::client
