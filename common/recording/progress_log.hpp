// SPDX-License-Identifier: MIT
// Lines of the log about a file whose reading lasts: a program that starts is not silent then.
// Thread: one.
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "common/recording/mcap_reader.hpp"
#include "common/time.hpp"

namespace hapticast {

/// Makes the lines about one reading.
class ProgressLines {
 public:
  /// Time before the first line. A large chunk delays it; it has to come within 2 s.
  static constexpr Duration kFirstAfter = std::chrono::seconds(1);
  /// Time between two lines; chosen.
  static constexpr Duration kEvery = std::chrono::seconds(5);

  /// `text` begins each line. `begin`: of the reading.
  ProgressLines(std::string text, LocalTime begin)
      : text_(std::move(text)), next_(begin + kFirstAfter) {}
  /// Returns the line with the share that is read at `now`; nullopt: none is due.
  [[nodiscard]] std::optional<std::string> makeLine(double share, LocalTime now) {
    if (now < next_) return std::nullopt;
    next_ = now + kEvery;
    return text_ + ": " + std::to_string(std::lround(100.0 * share)) + " %";
  }

 private:
  std::string text_;
  LocalTime next_;
};

/// Returns a function that logs the lines with `text`.
[[nodiscard]] inline ReadProgress logProgress(std::string text) {
  return [lines = ProgressLines(std::move(text), SteadyClock().now())](double share) mutable {
    if (const auto line = lines.makeLine(share, SteadyClock().now())) spdlog::info("{}", *line);
  };
}

/// Returns a function for McapReader::open() that logs how far the scan of `file` is.
[[nodiscard]] inline ReadProgress logScan(const std::string& file) {
  return logProgress("reading " + file + " from its start, because it has no summary");
}

}  // namespace hapticast
