// SPDX-License-Identifier: MIT
// Keeps the masks of the user's program in the folder mask/ of the clip, where later runs read them
// as the clip's own masks. A file beside them names the command, so the server never overwrites
// masks of the author. Thread: one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace hapticast::server {

/// The folder mask/ of a clip of images.
class MaskFolder {
 public:
  /// `names`: names of the masks in order of the frames, without an ending. `command`: the program
  /// with all that changes its masks. Throws SourceError if mask/ has masks of another origin.
  MaskFolder(const std::filesystem::path& clip, std::vector<std::string> names,
             std::string command);

  /// Returns whether the folder has all masks of the command.
  [[nodiscard]] bool isComplete() const { return complete_; }
  /// Writes the mask of frame `index`, a PNG; empty: it has none. Logs one warning if that is
  /// impossible.
  void store(std::uint64_t index, const std::vector<std::uint8_t>& png);

 private:
  /// Writes the file that names the command.
  bool writeOrigin() const;

  std::filesystem::path folder_;
  std::vector<std::string> names_;
  std::string command_;
  std::set<std::uint64_t> answered_;
  bool complete_ = false;
  bool failed_ = false;
};

}  // namespace hapticast::server
