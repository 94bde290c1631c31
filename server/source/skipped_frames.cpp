// SPDX-License-Identifier: MIT
#include "server/source/skipped_frames.hpp"

#include <spdlog/spdlog.h>

#include <bit>
#include <utility>

namespace hapticast::server {

void SkippedFrames::add(std::uint64_t index, const std::string& problem) {
  if (problem_.empty()) {
    problem_ = problem;
    first_ = index;
  }
  last_ = index;
  if (!live_) is_new_ = reported_.insert(index).second || is_new_;
}

void SkippedFrames::endRun() {
  if (problem_.empty()) return;
  if (live_) {
    if (std::has_single_bit(++runs_))
      spdlog::warn("{}; the picture is left out (time {})", problem_, runs_);
  } else if (is_new_ && first_ == last_) {
    spdlog::warn("{}; frame {} is left out", problem_, first_);
  } else if (is_new_) {
    spdlog::warn("{}; frames {} to {} are left out", problem_, first_, last_);
  }
  (void)cancelRun();
}

std::string SkippedFrames::cancelRun() {
  is_new_ = false;
  return std::exchange(problem_, "");
}

}  // namespace hapticast::server
