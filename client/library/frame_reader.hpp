// SPDX-License-Identifier: MIT
// Decodes received frames to frames of the library. Lost slices are concealed, as in the client.
// Thread: network.
#pragma once

#include <cstdint>
#include <optional>

#include "client/net/frame_assembler.hpp"
#include "client/net/relief_cache.hpp"
#include "common/include/hapticast/frame.hpp"
#include "common/library/frame_export.hpp"

namespace hapticast::client {

/// Reads the frames of a stream, in their order.
class FrameReader {
 public:
  /// Returns the frame with all its heights. `workspace` is that of the stream.
  [[nodiscard]] Frame read(const AssembledFrame& assembled, const Workspace& workspace);

 private:
  ReliefCache reliefs_{false};
  FrameExporter exporter_;
  std::optional<Workspace> workspace_;
  std::uint32_t epoch_ = 0;  // client-side
};

}  // namespace hapticast::client
