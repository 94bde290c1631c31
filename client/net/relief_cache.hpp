// SPDX-License-Identifier: MIT
// Reliefs prepared for touch, by object: what "unchanged" in a frame refers to. Thread: one
// (network).
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
  struct Found {
    std::shared_ptr<const HeightField> field;  ///< null: nothing to touch
    bool rejected = false;                     ///< a relief that does not fit the announced picture
  };

  /// A new stream: forgets everything. `method` chooses how heights are prepared.
  void reset(const Workspace& workspace, Method method);

  /// The field of an object of frame `frame_id`: prepared from its relief, or the one prepared
  /// before when it is the same. May allocate and take milliseconds.
  [[nodiscard]] Found resolve(const HapticObject& object, std::uint64_t frame_id);

 private:
  // Objects gone for longer than the newest ones are forgotten; who comes back gets the repeated
  // relief.
  static constexpr std::size_t kMaxEntries = 2 * kMaxObjects;
  struct Entry {
    std::uint64_t changed_in_frame = 0;
    std::uint64_t used_in_frame = 0;
    std::shared_ptr<const HeightField> field;
  };
  [[nodiscard]] bool fits(const Relief& relief) const;
  void forgetOldest();

  Workspace workspace_;
  Method method_ = Method::kHapticast;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Entry> entries_;  // by object id and layer
};

}  // namespace hapticast::client
