// SPDX-License-Identifier: MIT
// Lines that a user types at the terminal, without waiting for them. Thread: one.
#pragma once

#include <optional>
#include <string>

namespace hapticast::client {

class TerminalLines {
 public:
  /// Whether somebody reads stderr and types stdin, and this program may read what he types: one
  /// in the background would be stopped by that, with a force on.
  [[nodiscard]] bool isInteractive() const;
  /// What was typed so far was no answer to what is shown now. Only while asked().
  void discardPending();
  /// The next whole line, if there is one. Only while asked().
  std::optional<std::string> pop();

 private:
  std::string typed_;
  bool ended_ = false;
};

}  // namespace hapticast::client
