// SPDX-License-Identifier: MIT
// Files with secrets of the server: keys and tokens. Thread: main, at start-up and at a reload.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

namespace hapticast::server {

/// Error: a file with secrets is unusable. The user can correct it. The message is one line that
/// begins with the flag and states the remedy.
class KeyFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns a warning of one line if other users of this machine may read `file`; otherwise nullopt.
/// The line begins with `flag`. `risk` completes its text "other users may ...".
[[nodiscard]] std::optional<std::string> findReaders(const std::string& flag,
                                                     const std::string& file,
                                                     const std::string& risk);

}  // namespace hapticast::server
