// SPDX-License-Identifier: MIT
// Interface of the depth pictures of a clip whose colour comes from elsewhere, such as a colour
// video. There is one implementation for each kind of file. Thread: any; at most one at a time for
// each sequence.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

/// Depth pictures in the order of the frames.
class DepthSequence {
 public:
  virtual ~DepthSequence() = default;
  /// Returns the number of pictures, 1 or more.
  [[nodiscard]] virtual std::uint64_t count() const = 0;
  /// Returns the next picture as it is in the file (the caller converts it with toDepth()), or its
  /// problem as a phrase. The next call returns the picture after it in both cases. Returns nullopt
  /// after the last one.
  [[nodiscard]] virtual std::optional<ImageResult> next() = 0;
  /// Skips the next picture without decoding it if possible. Returns false after the last one.
  virtual bool skip() = 0;
  /// Begins again: next() returns the first picture.
  virtual void rewind() = 0;
  /// Returns the name for messages of the file with picture `index`. Requires: index < count().
  [[nodiscard]] virtual std::string pictureName(std::uint64_t index) const = 0;
};

}  // namespace hapticast::server
