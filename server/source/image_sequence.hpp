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
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// Decodes frame `index` into `frame`; what is wrong with it (naming the file), or "".
  std::string load(std::uint64_t index, RgbdFrame& frame) const;

  ClipFiles files_;
  SourceInfo info_;
  DepthFormat format_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  std::set<std::uint64_t>
      reported_;  // unreadable frames, so that a loop does not repeat its warnings
};

}  // namespace hapticast::server
