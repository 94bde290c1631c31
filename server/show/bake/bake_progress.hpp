// SPDX-License-Identifier: MIT
// Progress of a long work on stderr: one line that renews itself on a terminal, else a line of the
// log each 10 s. Thread: one.
#pragma once

#include <cstdint>
#include <string>

#include "common/time.hpp"

namespace hapticast::server {

/// The progress of one work after another.
class BakeProgress {
 public:
  /// `clock` must outlive this object. `quiet`: shows nothing.
  BakeProgress(const Clock& clock, bool quiet);
  /// Clears the line.
  ~BakeProgress() { clear(); }
  BakeProgress(const BakeProgress&) = delete;
  BakeProgress& operator=(const BakeProgress&) = delete;

  /// Begins a work. `work`: what the program does, such as "bakes".
  void begin(std::string work);
  /// Shows that `done` of `total` frames are done; `total` 0: unknown.
  void show(std::uint64_t done, std::uint64_t total);
  /// Clears the line, before lines of the log. Does nothing without one.
  void clear();

 private:
  const Clock& clock_;
  bool quiet_;
  bool on_terminal_;
  bool has_line_ = false;
  std::string work_;
  LocalTime began_, shown_;
};

/// Returns the text of the progress, such as "bakes: 43 %, 12.3 frames/s, 1:20 left".
[[nodiscard]] std::string describeProgress(const std::string& work, std::uint64_t done,
                                           std::uint64_t total, double elapsed_s);

}  // namespace hapticast::server
