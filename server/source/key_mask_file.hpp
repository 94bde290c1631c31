// SPDX-License-Identifier: MIT
// Name of a key mask's file, with its object and time. A plain value without OpenCV. Thread: any.
#pragma once

#include <string>

namespace hapticast::server {

/// Picture file that shows one object at one time of the clip: white on black.
struct KeyMaskFile {
  int number = 0;       ///< number of the object, 1..kMaxObjects
  double time_s = 0.0;  ///< time in the clip, s
  std::string file;
  bool operator==(const KeyMaskFile&) const = default;
};

}  // namespace hapticast::server
