// SPDX-License-Identifier: MIT
// Source from a folder of image files (layouts: clip_files.hpp). Decodes images one by one, on
// read. Thread: one.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "server/source/clip_files.hpp"
#include "server/source/image_file.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Source of one folder.
class ImageSequence final : public RgbdSource {
 public:
  /// Finds the files and checks the first frame. `fps` > 0 overrides the folder's rate. Throws
  /// SourceError.
  ImageSequence(const std::filesystem::path& folder, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Throws SourceError if a whole round has no readable frame: the files vanished.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// Decodes frame `index` into `frame`. Returns the problem with the file's name, or "".
  std::string load(std::uint64_t index, RgbdFrame& frame) const;
  /// Throws SourceError if a key mask is unreadable, has another size or shows no object: the
  /// author's masks are never skipped silently.
  void checkKeyMasks() const;
  /// Returns the problem with the size of `image`, or "".
  [[nodiscard]] std::string otherSize(const cv::Mat& image) const;
  /// Reads and converts a mask, or returns its problem.
  [[nodiscard]] ImageResult readMask(const std::filesystem::path& file) const;
  /// Returns whether the frame's files no longer exist.
  static bool vanished(const FrameFiles& frame);
  /// Warns about the skipped frames first .. end - 1, unless there are none or earlier rounds
  /// reported all. `problem`: the first frame's.
  void exclude(std::uint64_t first, std::uint64_t end, const std::string& problem);

  ClipFiles files_;
  SourceInfo info_;
  DepthFormat format_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool any_read_ = false;  // of this round
  // Unreadable frames, so that a loop does not repeat its warnings.
  std::set<std::uint64_t> reported_;
};

}  // namespace hapticast::server
