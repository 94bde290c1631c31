// SPDX-License-Identifier: MIT
// The reliefs of the stream by object: what "unchanged" in a frame refers to. A relief is kept as
// slices until a frame that is played needs it, and decoded and prepared for touch then: of a frame
// that is left out only the slices have to be remembered. They stay, for a relief that is sent
// again without a change is the same to touch, whatever frame it is told to have changed in. What a
// relief lacks is carried over from the one before. Thread: one (the preparer's).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "client/net/error_concealment.hpp"
#include "common/codec/coded_frame.hpp"
#include "common/relief/height_field.hpp"

namespace hapticast::client {

class ReliefCache {
 public:
  /// The answer to resolve().
  struct Resolved {
    std::shared_ptr<const HeightField> field;  ///< null: nothing to touch
    bool rejected = false;                     ///< a relief that does not fit the announced picture
    /// Slices that never came, and slices that could not be decoded; counted once for each relief.
    std::uint64_t slices_lost = 0;
    std::uint64_t slices_refused = 0;
  };

  /// Begins a new stream: forgets everything. `method` chooses how heights are prepared.
  void reset(const Workspace& workspace, Method method);

  /// Another epoch: nothing of the one before goes on in it.
  void forget() { entries_.clear(); }
  /// Remembers the relief of an object of frame `frame_id`, or that it was used again, without
  /// decoding it.
  void remember(const CodedObject& object, std::uint64_t frame_id);
  /// Remembers the relief and returns it prepared for touch. A relief of which slices are missing,
  /// or all of which never came, is touched where there was one before it, from which they are
  /// carried over. May allocate and take milliseconds, once for each change of a relief.
  [[nodiscard]] Resolved resolve(const CodedObject& object, std::uint64_t frame_id);

  /// Objects gone for longer than these newest ones are forgotten; who comes back is sent the
  /// repeated relief. Chosen: twice what a frame can hold.
  static constexpr std::size_t kMaxEntries = 2 * kMaxObjects;

 private:
  struct Entry {
    std::uint64_t changed_in_frame = 0;
    std::uint64_t used_in_frame = 0;
    std::shared_ptr<const CodedRelief> coded;
    Motion motion;       // of the object when it looked so
    PosedRelief before;  // the last one that was decoded, if any; once this one is, it
    bool decoded = false;
    Resolved resolved;  // once it is decoded
  };
  /// What changed never came: what was there before goes on in its place.
  void concealAll(Entry& entry, const CodedObject& object) const;
  Resolved prepare(Entry& entry);
  /// The relief of an entry; null where slices are missing that nothing can be carried over for.
  std::shared_ptr<const Relief> decode(const Entry& entry, Resolved& counts);
  [[nodiscard]] bool inPicture(const PixelRect& rect) const;
  void forgetOldest();

  Workspace workspace_;
  Method method_ = Method::kHapticast;
  HeightDecoder decoder_;
  std::map<ObjectKey, Entry> entries_;
};

}  // namespace hapticast::client
