// SPDX-License-Identifier: MIT
// The reliefs of the stream by object: what "unchanged" in a frame refers to. A relief is kept raw
// until a frame that is played needs it, and prepared for touch then: of a frame that is left out
// only the raw relief has to be remembered. The raw one stays, for one that is sent again without a
// change is the same to touch, whatever frame it is told to have changed in. Thread: one (the
// preparer's).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "common/haptic_frame.hpp"
#include "common/relief/height_field.hpp"

namespace hapticast::client {

class ReliefCache {
 public:
  /// The answer to resolve().
  struct Resolved {
    std::shared_ptr<const HeightField> field;  ///< null: nothing to touch
    bool rejected = false;                     ///< a relief that does not fit the announced picture
  };

  /// Begins a new stream: forgets everything. `method` chooses how heights are prepared.
  void reset(const Workspace& workspace, Method method);

  /// Remembers the relief of an object of frame `frame_id`, or that it was used again, without
  /// preparing it. Returns false when the relief does not fit the announced picture (then it is not
  /// remembered).
  bool remember(const HapticObject& object, std::uint64_t frame_id);
  /// Remembers the relief and returns it prepared for touch. May allocate and take milliseconds,
  /// once for each change of a relief.
  [[nodiscard]] Resolved resolve(const HapticObject& object, std::uint64_t frame_id);

  /// Objects gone for longer than these newest ones are forgotten; who comes back is sent the
  /// repeated relief. Chosen: twice what a frame can hold.
  static constexpr std::size_t kMaxEntries = 2 * kMaxObjects;

 private:
  struct Entry {
    std::uint64_t changed_in_frame = 0;
    std::uint64_t used_in_frame = 0;
    std::shared_ptr<const Relief> raw;
    std::shared_ptr<const HeightField> field;  // null until it is needed
  };
  [[nodiscard]] bool fits(const Relief& relief) const;
  void forgetOldest();

  Workspace workspace_;
  Method method_ = Method::kHapticast;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Entry> entries_;  // by object id and layer
};

}  // namespace hapticast::client
