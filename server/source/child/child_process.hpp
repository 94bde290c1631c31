// SPDX-License-Identifier: MIT
// Runs a command of the user as a child process with three pipes: its stdin, stdout and stderr. The
// child is the leader of a session of its own, so Ctrl-C in the terminal ends the server first, and
// the end of the child ends its whole process group. Thread: one at a time.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

namespace hapticast::server {

/// A file descriptor that is closed with its owner. Thread: one.
class OwnedDescriptor {
 public:
  explicit OwnedDescriptor(int number = -1) : number_(number) {}
  ~OwnedDescriptor() { close(); }
  OwnedDescriptor(OwnedDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  /// Returns the number; -1: it is closed.
  [[nodiscard]] int get() const { return number_; }
  void close();

 private:
  int number_;
};

/// One run of a command.
class ChildProcess {
 public:
  /// Starts `command` in /bin/sh. It ends with the thread that starts it. Throws SourceError (one
  /// line) if that is impossible.
  explicit ChildProcess(const std::string& command);
  /// Ends the child as end() does.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The server's ends of the pipes. They do not block.
  OwnedDescriptor input;   ///< the child's stdin
  OwnedDescriptor output;  ///< its stdout
  OwnedDescriptor errors;  ///< its stderr

  /// Closes the pipes, which ends most programs. A child that has not ended after 0.3 s receives
  /// SIGTERM, and after 0.6 s SIGKILL, with its process group. Returns how it ended by itself, for
  /// a message: "exit code 1", "signal 9 (Killed)". Returns "" if it did not.
  std::string end();

 private:
  pid_t pid_ = -1;
};

}  // namespace hapticast::server
