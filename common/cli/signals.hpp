// SPDX-License-Identifier: MIT
// Whether a program is to outlive its terminal. Thread: main, at start-up.
#pragma once

#include <csignal>

namespace hapticast {

/// Whether SIGHUP was ignored before this program began, as nohup arranges it: then it stays so.
inline bool sighupIgnored() {
  struct sigaction before {};
  return ::sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

}  // namespace hapticast
