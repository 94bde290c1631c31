// SPDX-License-Identifier: MIT
// Decodes received frames to frames of the library. Lost slices are concealed, as in the client.
// Thread: one.
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
  /// Notes the heights of a frame that the caller does not need, without decoding them.
  void skip(const AssembledFrame& assembled, const Workspace& workspace);

 private:
  /// Forgets all heights where another stream or epoch begins.
  void beginFrame(const AssembledFrame& assembled, const Workspace& workspace);

  ReliefCache reliefs_{false};
  FrameExporter exporter_;
  std::optional<Workspace> workspace_;
  std::uint32_t epoch_ = 0;  // client-side
};

}  // namespace hapticast::client
