// SPDX-License-Identifier: MIT
// The depth of a whole clip in one array (frames, height, width): an NPY file, or an NPZ file with
// such an array (Video-Depth-Anything). Pictures are read one by one, because files may have
// gigabytes. Thread: any; at most one at a time for each stack.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "server/source/picture/depth_sequence.hpp"
#include "server/source/picture/npy_array.hpp"

namespace hapticast::server {

/// Returns whether the name of `file` ends like that of an array (.npy or .npz).
[[nodiscard]] bool isArrayName(const std::filesystem::path& file);

/// The pictures of one array.
class NpyStack final : public DepthSequence {
 public:
  /// Opens `file` and reads its header. Throws SourceError if it is no such array.
  explicit NpyStack(const std::filesystem::path& file);
  /// Reads the header from `stream`, an NPY file at its begin. `name`: for messages. Throws
  /// SourceError.
  NpyStack(std::unique_ptr<ByteStream> stream, std::string name);

  [[nodiscard]] std::uint64_t count() const override { return header_.count; }
  /// Returns the size of each picture.
  [[nodiscard]] cv::Size size() const { return header_.size; }
  /// Returns the next picture: CV_8UC1, CV_16UC1 or CV_32FC1.
  [[nodiscard]] std::optional<ImageResult> next() override;
  bool skip() override;
  void rewind() override { next_ = 0; }
  [[nodiscard]] std::string pictureName(std::uint64_t /*index*/) const override { return name_; }

  /// Moves to picture `index`, which next() then returns. Requires: index < count().
  void seek(std::uint64_t index) { next_ = index; }
  /// Returns whether pictures may be read in any order without a long delay. Those of a compressed
  /// array can only be read forwards: a step back reads the array again from its begin.
  [[nodiscard]] bool seeksBackwards() const { return stream_->seeksBackwards(); }

 private:
  std::unique_ptr<ByteStream> stream_;
  std::string name_;
  NpyHeader header_;
  std::uint64_t next_ = 0;
};

}  // namespace hapticast::server
