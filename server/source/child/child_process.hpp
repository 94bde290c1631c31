// SPDX-License-Identifier: MIT
// Runs a command of the user as a child process with three pipes: its stdin, stdout and stderr. The
// child is the leader of a session of its own, so Ctrl-C in the terminal ends the server first, and
// the end of the child ends its whole process group. Thread: one at a time.
#pragma once

#include <sys/types.h>

#include <string>

#include "server/source/owned_descriptor.hpp"

namespace hapticast::server {

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
