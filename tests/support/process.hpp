// SPDX-License-Identifier: MIT
// Runs a real program as a child: its output in a file, signals, deadlines. Nothing of it outlives
// the object. Thread: one.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/waiting.hpp"

namespace hapticast::testing {

class Process {
 public:
  /// Starts `command` (program and arguments); what it says on stdout and stderr is kept together.
  /// A program that cannot be run ends with 127. Throws std::runtime_error if there is no process.
  explicit Process(std::vector<std::string> command) : Process(std::move(command), "/dev/null") {}
  /// Starts it with `input` as standard input. A terminal becomes its controlling terminal.
  Process(std::vector<std::string> command, const std::string& input);
  /// Runs `program`, the main function of a program, in a child of this process. It costs a tenth
  /// of the start of a program, which loads its libraries. Requires that no other thread runs.
  explicit Process(const std::function<int()>& program);
  /// Kills it if it still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// All it has said so far.
  [[nodiscard]] std::string output() const;
  /// Whether it says `text` `times` times before `deadline`; gives up when it ends without.
  bool says(const std::string& text, std::chrono::seconds deadline, std::size_t times = 1);
  /// Its exit code, 128 + the signal that ended it, or nullopt if it still runs after `deadline`.
  std::optional<int> wait(std::chrono::seconds deadline);
  void signal(int number) const;
  [[nodiscard]] bool running();
  [[nodiscard]] pid_t id() const { return pid_; }
  /// Its resident memory in kB, 0 when it has ended.
  [[nodiscard]] long residentMemory_kB() const;

 private:
  /// Makes a child process for `program`; returns true in the child. Throws std::runtime_error
  /// (with `program`) if there is none.
  bool forkChild(const std::string& program);

  pid_t pid_ = -1;
  std::optional<int> exit_code_;
  std::string output_file_;
};

/// How often `text` stands in `where`.
std::size_t countOccurrences(const std::string& text, const std::string& where);

}  // namespace hapticast::testing
