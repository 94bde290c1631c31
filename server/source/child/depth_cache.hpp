// SPDX-License-Identifier: MIT
// Cache on disk of the depth that a program has estimated. The folder of a clip has the SHA-256 of
// the clip's files, of the size of its frames and of the command as its name, and one file for each
// frame: the answer, compressed by zstd. If the cache grows beyond its limit, the clips that were
// used least recently are deleted. Thread: one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/source/child/child_pipe.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Returns a text that changes with `files` (paths, sizes and times of the clip's colours), with
/// the size of its frames and with `command`. Without files `spec`, the value of --source, stands
/// in their place.
[[nodiscard]] std::string describeCachedClip(const std::string& spec,
                                             const std::vector<std::filesystem::path>& files,
                                             const SourceInfo& info, const std::string& command);

/// The cache of one clip.
class DepthCache {
 public:
  /// `folder`: that of all clips; it is created. `clip`: see describeCachedClip(). Throws
  /// SourceError if the folder cannot be written.
  DepthCache(const std::filesystem::path& folder, double limit_GB, const std::string& clip);

  /// Returns the answer of a frame; nullopt if the cache does not have it or if it is damaged.
  [[nodiscard]] std::optional<ChildAnswer> load(std::uint64_t index) const;
  /// Stores the answer of a frame. Logs one warning if that is impossible, and stores no more.
  void store(std::uint64_t index, const ChildAnswer& answer);

 private:
  [[nodiscard]] std::filesystem::path file(std::uint64_t index) const;
  /// Deletes other clips until `bytes` more fit. Returns whether they fit.
  bool makeRoom(std::uint64_t bytes);
  void warnOnce(const std::string& problem);

  std::filesystem::path folder_;
  std::filesystem::path clip_folder_;
  std::uint64_t limit_bytes_;
  std::uint64_t used_bytes_ = 0;  // of all clips
  bool warned_ = false;
};

}  // namespace hapticast::server
