// SPDX-License-Identifier: MIT
// The frames of a recording, one after the other. Thread: any; the object locks itself.
#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "frames.hpp"
#include "hapticast/recording.hpp"

namespace hapticast::python {

class RecordedFrames {
 public:
  explicit RecordedFrames(Recording recording) : recording_(std::move(recording)) {}
  /// Returns the next frame; nullopt at the end. Call it without Python's lock.
  [[nodiscard]] std::optional<StreamFrame> next();

 private:
  std::mutex mutex_;
  Recording recording_;
};

/// Returns the frames of a Recording, a RecordedFrames; any other object as it is.
py::object openFrames(const py::object& from);

}  // namespace hapticast::python
