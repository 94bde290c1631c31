// SPDX-License-Identifier: MIT
#include "client/discovery/terminal_input.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>

namespace hapticast::client {

bool TerminalLines::isInteractive() const {
  return !ended_ && ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1 &&
         ::tcgetpgrp(STDIN_FILENO) == ::getpgrp();
}

void TerminalLines::discardPending() {
  typed_.clear();
  ::tcflush(STDIN_FILENO, TCIFLUSH);
}

std::optional<std::string> TerminalLines::pop() {
  constexpr std::size_t kMost_bytes = 4096;  // a terminal's own limit of a line
  pollfd terminal{STDIN_FILENO, POLLIN, 0};
  if (::poll(&terminal, 1, 0) == 1) {
    std::array<char, 256> bytes{};
    const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count <= 0) ended_ = true;
    if (count > 0 && typed_.size() < kMost_bytes)
      typed_.append(bytes.data(), static_cast<std::size_t>(count));
  }
  const std::size_t end = typed_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = typed_.substr(0, end);
  typed_.erase(0, end + 1);
  return line;
}

}  // namespace hapticast::client
