// SPDX-License-Identifier: MIT
// Source from a folder of image files (layouts: clip_files.hpp). Each image is decoded when its
// frame is read. Thread: one.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/source/folder/clip_files.hpp"
#include "server/source/picture/image_file.hpp"
#include "server/source/picture/npy_stack.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/skipped_frames.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Source whose frames are the images of one folder.
class ImageSequence final : public RgbdSource {
 public:
  /// Finds the files in `folder` and checks the first frame. `fps` > 0 overrides the folder's rate,
  /// frames/s. If `to_and_fro` is true, the clip plays forwards, then backwards from the last but
  /// one image to the second, so that a loop has no jump. `layout`: its code is that of 8-bit
  /// depth, kGrey or kInverse; its unit wins over all that the folder states. Throws SourceError,
  /// also if the code is kInverse and the depth is in mm, or if depth of 8 bits has a unit.
  ImageSequence(const std::filesystem::path& folder, double fps, bool to_and_fro = false,
                const VideoLayout& layout = {});

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the next frame, as in RgbdSource. Throws SourceError if no frame of the whole clip is
  /// readable, for example because the files were deleted.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// Decodes frame `index` into `frame`. Returns the problem with the file's name, or "" on
  /// success.
  std::string load(std::uint64_t index, RgbdFrame& frame) const;
  /// Sets the name, the sizes, the kind of depth and its unit from the files of `first`, a frame
  /// with depth, or with VideoLayout::color_only any frame. Throws SourceError.
  void describe(const std::filesystem::path& folder, const FrameFiles& first);
  /// Sets the size and the kind of depth and its unit. Throws SourceError.
  void describeDepth(const std::filesystem::path& folder, const FrameFiles& first);
  /// Logs a warning if meta.json states another size than that of the pictures.
  void warnOfOtherSize(const std::filesystem::path& folder) const;
  /// Checks all key masks. Throws SourceError if one is unreadable, has another size or shows no
  /// object, because the author's masks must not be skipped silently.
  void checkKeyMasks() const;
  /// Returns the problem if `image` has another size than the clip's own pictures; otherwise "".
  [[nodiscard]] std::string otherSize(const cv::Mat& image) const;
  /// Returns the colour image in `file` at the size of the frames, or its problem.
  [[nodiscard]] ImageResult readColor(const std::filesystem::path& file) const;
  /// Opens the array with the depth of all frames. Throws SourceError if `to_and_fro` is true and
  /// the array can only be read forwards.
  void openArray(bool to_and_fro);
  /// Returns the depth image of `files` as it is in its file, or its problem.
  [[nodiscard]] ImageResult readRawDepth(const FrameFiles& files) const;
  /// Returns the depth image of `files` at the size of `color`, the picture of the frame, or its
  /// problem.
  [[nodiscard]] ImageResult readDepth(const FrameFiles& files, const cv::Mat& color) const;
  /// Sets the size of the depth images from the first one, and logs if they are scaled.
  void chooseDepthSize(const std::filesystem::path& folder, const cv::Mat& first);
  /// Returns the mask in `file`, converted by toMask(), at the size of the frames, or its problem.
  [[nodiscard]] ImageResult readMask(const std::filesystem::path& file) const;
  /// Returns the masks of single objects as one mask, at the size of the frames, or their problem
  /// with the file's name. Where two overlap, the later one covers the other.
  [[nodiscard]] ImageResult joinMasks(const std::vector<std::filesystem::path>& files) const;
  /// Returns whether the frame's files no longer exist.
  static bool hasVanished(const FrameFiles& frame);

  ClipFiles files_;
  std::unique_ptr<NpyStack> array_;  // depth of all frames; null: each frame has its own file
  SourceInfo info_;
  DepthFormat format_;
  VideoLayout layout_;
  cv::Size own_size_;  // sizes of colour and depth images in the files
  cv::Size depth_size_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool any_read_ = false;  // whether a frame was read since the clip's start
  SkippedFrames skipped_;
};

}  // namespace hapticast::server
