// SPDX-License-Identifier: MIT
// The file of a bake. It grows as FILE.mcap.part and gets its name when it is complete. It consists
// of blocks of about a second, each with a description and all reliefs, that do not depend on each
// other. So a bake that was interrupted continues after its last whole block, with the same bytes.
// Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/recording/mcap_writer.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// A recording that a bake writes.
class BakedFile {
 public:
  /// Creates `file`.part. `fingerprint`: text about clip and flags, the first line of the log in
  /// the file. `block`: frames of a block. `resume`: an existing .part of the same fingerprint
  /// keeps its whole blocks. Throws RecordingError with one line if `file` exists, if a .part
  /// exists that cannot be continued, or if the file cannot be written.
  BakedFile(const std::string& file, const std::string& fingerprint, std::uint64_t block,
            bool resume);
  /// Writes what waits. A .part without a frame is removed.
  ~BakedFile();
  BakedFile(const BakedFile&) = delete;
  BakedFile& operator=(const BakedFile&) = delete;

  /// Returns the number of frames that the file already has.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Returns whether the next frame begins a block.
  [[nodiscard]] bool beginsBlock() const { return frames_ % block_ == 0; }
  /// Adds a frame with its picture (JPEG). The description is that of the first frame of a block.
  /// Throws std::runtime_error if the disk refuses bytes.
  void add(const StreamDescription& description, const HapticFrame& frame,
           const SliceSettings& slices, std::vector<std::uint8_t> jpeg);
  /// Completes the file and gives it its name. Throws std::runtime_error with one line.
  void finish();

 private:
  void keepBlocks(const std::string& fingerprint);
  void endFrame();
  void requireWritten() const;

  std::string file_;
  std::string part_;
  std::uint64_t block_;
  std::uint64_t frames_ = 0;
  std::optional<McapWriter> writer_;
  FrameEncoder encoder_;
};

}  // namespace hapticast::server
