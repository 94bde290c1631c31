// SPDX-License-Identifier: MIT
// One held scene, measured: the clip from one click and after corrections, starts from anywhere.
// Thread: any; values.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "tests/evaluate/held/held_trials.hpp"

namespace hapticast::evaluate::held {

/// All that is measured of one scene.
struct Result {
  std::string name, sensor;
  bool held_at_start = false, reported_apart = false;
  Scores one_click;
  std::string refused;
  Starts starts;  ///< at the first frame
  std::optional<Trials> trials;
  /// After one and two corrections: points at what is most wrong in the clip, or true masks of the
  /// frames that are most wrong.
  std::array<Scores, 2> by_points, by_masks;
};

/// How much is measured of a scene.
struct Effort {
  double clicks = 40.0;  ///< that are tried inside the object
  bool trials = true;    ///< held_trials.hpp
};
/// Draws a contact sheet into `sheets` (empty: none).
Result measure(const Scene& scene, const std::filesystem::path& sheets, const Effort& effort);

/// Run times of a scene, and whether two threads have the results of one.
struct Times {
  double median_ms = 0.0, slow_ms = 0.0;          ///< CPU of one thread; the latter: 95 %
  double one_frames_s = 0.0, two_frames_s = 0.0;  ///< with one thread and with two
  std::size_t different_frames = 0;
};
/// Run time alone, in a picture of another size, of the first frames.
Times timesOf(const Scene& scene, const cv::Size& size, std::size_t frames);

}  // namespace hapticast::evaluate::held
