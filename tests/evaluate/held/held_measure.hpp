// SPDX-License-Identifier: MIT
// One held scene, measured: the clip from one click and after corrections, starts from anywhere.
// Thread: any; values.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "tests/evaluate/held/held_run.hpp"

namespace hapticast::evaluate::held {

/// What clicks anywhere inside an object begin with.
struct Starts {
  std::size_t clicks = 0, good = 0, bad = 0, refused = 0;

  void add(const Starts& other) {
    clicks += other.clicks;
    good += other.good;
    bad += other.bad;
    refused += other.refused;
  }
  [[nodiscard]] double share(std::size_t of) const {
    return double(of) / std::max(1.0, double(clicks));
  }
};

/// All that is measured of one scene.
struct Result {
  std::string name, sensor;
  bool held_at_start = false;
  Scores one_click;
  std::string refused;
  Starts starts;
  /// After one and two corrections: points at what is most wrong in the clip, or true masks of the
  /// frames that are most wrong.
  std::array<Scores, 2> by_points, by_masks;
};

/// Draws a contact sheet into `sheets` (empty: none); `clicks` inside the object are tried.
Result measure(const Scene& scene, const std::filesystem::path& sheets, double clicks);

/// Run time alone, in a picture of another size, of the first frames.
Scores timesOf(const Scene& scene, const cv::Size& size, std::size_t frames);

}  // namespace hapticast::evaluate::held
