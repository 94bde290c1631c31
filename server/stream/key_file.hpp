// SPDX-License-Identifier: MIT
// Files with secrets of the server: keys and tokens. Thread: main, at start-up and at a reload.
#pragma once

#include <stdexcept>
#include <string>

namespace hapticast::server {

/// Reports a file with secrets that cannot be used. It is an error of the user. The message is one
/// line, begins with the flag and has the remedy.
class KeyFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Logs a warning if other users of this machine may read `file`. `flag` begins the line, and
/// `risk` completes "other users may ...".
void warnOfReaders(const std::string& flag, const std::string& file, const std::string& risk);

}  // namespace hapticast::server
