// SPDX-License-Identifier: MIT
// Frames that a source leaves out because they are unusable. Each run of them gives one warning: a
// clip that plays again does not repeat it, and a live source logs the first run and every
// doubling. Thread: one.
#pragma once

#include <cstdint>
#include <set>
#include <string>

namespace hapticast::server {

/// The unusable frames of one source.
class SkippedFrames {
 public:
  /// `live`: the source never comes back to a frame.
  explicit SkippedFrames(bool live = false) : live_(live) {}

  /// Adds frame `index` with `problem`, a phrase with the name of the file or device. Frames of one
  /// run are added in order.
  void add(std::uint64_t index, const std::string& problem);
  /// Ends the run, if there is one: logs its first problem, unless an earlier playback of the clip
  /// logged all of its frames.
  void endRun();
  /// Ends the run without a line of the log. Returns the problem of its first frame; "" if there is
  /// no run.
  [[nodiscard]] std::string cancelRun();
  /// Returns the problem of the run's first frame; "" if there is no run.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  bool live_;
  std::string problem_;
  std::uint64_t first_ = 0;
  std::uint64_t last_ = 0;
  bool is_new_ = false;               // whether a frame of the run was not reported yet
  std::set<std::uint64_t> reported_;  // frames of a clip whose warning was logged
  std::uint64_t runs_ = 0;            // of a live source
};

}  // namespace hapticast::server
