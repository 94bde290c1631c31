// SPDX-License-Identifier: MIT
// A folder of image files as a source (layouts: clip_files.hpp). Images are decoded one by one as
// they are read. Thread: one.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "server/source/clip_files.hpp"
#include "server/source/image_file.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

class ImageSequence final : public RgbdSource {
 public:
  /// Finds the files and checks the first frame. `fps` > 0 overrides what the folder says. Throws
  /// SourceError.
  ImageSequence(const std::filesystem::path& folder, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Throws SourceError where no frame of a round could be read: the files have gone.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// Decodes frame `index` into `frame`; what is wrong with it (naming the file), or "".
  std::string load(std::uint64_t index, RgbdFrame& frame) const;
  /// Throws SourceError where a key mask cannot be read, has another size or shows no object: what
  /// the author drew is not passed over silently.
  void checkKeyMasks() const;
  /// What is wrong with the size of `image`, or "".
  [[nodiscard]] std::string otherSize(const cv::Mat& image) const;
  /// A mask's picture, or what is wrong with it.
  [[nodiscard]] ImageResult readMask(const std::filesystem::path& file) const;
  /// Warns of the frames first .. end - 1, which were passed over; does nothing where there are
  /// none or all were warned of in an earlier round. `problem`: the first one's.
  /// Whether its files, which were there when the clip was opened, are gone.
  static bool vanished(const FrameFiles& frame);
  void exclude(std::uint64_t first, std::uint64_t end, const std::string& problem);

  ClipFiles files_;
  SourceInfo info_;
  DepthFormat format_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool any_read_ = false;  // of this round
  std::set<std::uint64_t>
      reported_;  // unreadable frames, so that a loop does not repeat its warnings
};

}  // namespace hapticast::server
