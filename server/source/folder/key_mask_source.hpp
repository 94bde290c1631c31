// SPDX-License-Identifier: MIT
// Adds the key masks of a scene file to the frames of another source. Thread: one.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "server/source/key_mask_file.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Source of recorded frames to which the author drew key masks.
class KeyMaskSource final : public RgbdSource {
 public:
  /// Checks `masks` against `source`. A mask belongs to the frame that is nearest to its time. Each
  /// mask picture has the size of the clip's own pictures, and is white (or not black) on the
  /// object. read() decodes it again with its frame. Throws SourceError if a mask is unreadable, is
  /// empty, has a time after the end of the clip, or has another size. Also throws it if the source
  /// is live or has masks for all its frames.
  KeyMaskSource(std::unique_ptr<RgbdSource> source, const std::vector<KeyMaskFile>& masks);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  std::optional<RgbdFrame> read() override;
  bool skip() override { return source_->skip(); }
  void rewind() override { source_->rewind(); }

 private:
  void add(const KeyMaskFile& mask);
  [[nodiscard]] cv::Mat draw(const std::vector<KeyMaskFile>& masks) const;

  std::unique_ptr<RgbdSource> source_;
  SourceInfo info_;
  std::map<std::uint64_t, std::vector<KeyMaskFile>> masks_;  // by index of the frame
};

/// Returns `source` with these key masks. Without masks the result is `source` itself. Throws
/// SourceError.
std::unique_ptr<RgbdSource> addKeyMasks(std::unique_ptr<RgbdSource> source,
                                        const std::vector<KeyMaskFile>& masks);

}  // namespace hapticast::server
