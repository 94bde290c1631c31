// SPDX-License-Identifier: MIT
// Preparation of received frames without a thread: the owner calls step(). For owners in whose time
// everything happens, such as a web page or a caller of the library. Thread: one.
#pragma once

#include <functional>
#include <utility>

#include "client/net/frame_preparer.hpp"

namespace hapticast::client {

class InlinePreparation final : public FrameSink {
 public:
  /// The arguments are those of FramePreparer.
  InlinePreparation(FramePool& pool, const Clock& clock, Method method,
                    std::function<void(const PreparedFrame&)> done)
      : preparer_(pool, clock, method, std::move(done)) {}

  void reset(const Workspace& workspace) override { queue_.reset(workspace); }
  std::size_t push(AssembledFrame assembled) override { return queue_.push(std::move(assembled)); }
  /// Prepares the oldest queued frame. Returns false if there is none, or if it has to wait
  /// (FramePreparer::holdsBack()).
  bool step() {
    if (preparer_.holdsBack()) return false;
    const auto accepted = queue_.pop();
    if (accepted) preparer_.prepare(*accepted);
    return accepted.has_value();
  }

 private:
  FrameQueue queue_;
  FramePreparer preparer_;
};

}  // namespace hapticast::client
