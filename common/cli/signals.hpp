// SPDX-License-Identifier: MIT
// Inherited signal disposition of SIGHUP. Thread: main, at start-up.
#pragma once

#include <csignal>

namespace hapticast {

/// Returns whether SIGHUP was ignored at the program's start, as nohup arranges; then it stays
/// ignored.
inline bool sighupIgnored() {
  struct sigaction before {};
  return ::sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

}  // namespace hapticast
