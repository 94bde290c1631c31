// SPDX-License-Identifier: MIT
// Logs the unusable frames that a source skips. Each run of successive unusable frames causes one
// warning. A clip that plays again does not repeat the warning. A live source logs the runs number
// 1, 2, 4, 8 and so on. Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// The unusable frames of one source.
class SkippedFrames {
 public:
  /// `live`: true if the source never delivers a frame again (no rewind).
  explicit SkippedFrames(bool live = false) : live_(live) {}

  /// Returns the next usable frame of a source, or nullopt at its end. `grab` moves the source to
  /// its next frame and returns false at the end. `load` sets the frame with its index, and returns
  /// its problem, or "".
  template <class Grab, class Load>
  [[nodiscard]] std::optional<RgbdFrame> readNext(Grab grab, Load load) {
    while (grab()) {
      RgbdFrame frame;
      const std::string problem = load(frame);
      if (problem.empty()) {
        endRun();
        return frame;
      }
      add(frame.index, problem);
    }
    return std::nullopt;
  }
  /// Adds the unusable frame `index`. `problem`: its cause, a phrase with the name of the file or
  /// device. Add the frames of a run in order.
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
