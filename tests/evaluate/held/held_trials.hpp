// SPDX-License-Identifier: MIT
// Trials on a recorded scene: clicks at other frames, corrections at random times,
// turned pictures, and GrabCut anew in every frame. Thread: any; values.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "tests/evaluate/held/held_run.hpp"

namespace hapticast::evaluate::held {

/// Results of clicks anywhere inside an object.
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

/// Tries some `clicks` clicks inside the object, 3 px from its edge and more, on a recording that
/// begins at `frame`.
Starts clickAround(const Recording& recording, std::size_t frame, double clicks);

/// A connected piece of one frame's mask that is foreign, or of the object that is missing.
struct WrongPiece {
  double share = 0.0;  ///< of the object's area
  Vec2 middle_px = Vec2::Zero();
  double depth_px = 0.0;  ///< from its edge to its middle
  bool foreign = false;
};
/// Returns the largest one of a frame; nullopt: nothing is wrong.
std::optional<WrongPiece> findLargestWrong(const Recording& recording, const Run& run,
                                           std::size_t frame);

/// Two corrections, each at a random time.
struct Corrected {
  Scores scores;
  int emptied = 0;        ///< corrections after which less than a tenth of the object was left
  int uninformative = 0;  ///< corrections that said nothing new: a --not on a hand
};
/// Makes them, starting from `run`, the result of `words`.
Corrected correctAtRandomTimes(const Recording& recording, const Run& run, const Words& words);

/// Mean IoU over every fifth frame; < 0: no such frame.
struct CutScores {
  double grab_cut = -1.0;  ///< of GrabCut around a click on the true mask's middle
  double carried = -1.0;   ///< of the run's mask in the same frames
};
CutScores compareWithGrabCut(const Recording& recording, const Run& run);

/// The smallest overlap of the first mask with those of the picture turned by 90, 180 and 270
/// degrees, turned back; < 0: nothing to click on.
struct TurnedScores {
  double on_object = -1.0, on_hand = -1.0;  ///< where the click is
};
TurnedScores compareTurned(const Recording& recording);

/// All of it.
struct Trials {
  std::array<Starts, 3> starts;  ///< at the first frame, a third and two thirds of the clip
  /// IoU of the mask that vision chooses there without a click; < 0: not tried.
  std::array<double, 3> chosen_iou{-1.0, -1.0, -1.0};
  Corrected corrected;
  CutScores cut;
  TurnedScores turned;
};
/// `run` is the result of `click`; `clicks` are tried at each of the three frames.
Trials tryOut(const Recording& recording, const Run& run, const Words& click, double clicks);

}  // namespace hapticast::evaluate::held
