// SPDX-License-Identifier: MIT
// Starts and ends the program hapticast-device. The program file is in the folder of the client's
// program file, or in /usr/lib/hapticast.
// Thread: one at a time.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>

#include "client/device/helper/messages.hpp"
#include "client/device/helper/shared_page.hpp"

namespace hapticast::client {

/// Returns the path of hapticast-device. If neither folder has the file, returns the path in the
/// client's folder.
std::string findHelperProgram();

/// One run of the helper.
class HelperProcess {
 public:
  /// Starts `program` for the driver `driver`. `task` is "list" or "open". The driver receives the
  /// entries of `options` whose value is not empty. `page` may be null for "list". Throws
  /// std::runtime_error (one line) if the program cannot be started.
  HelperProcess(const std::string& program, const std::string& driver, const char* task,
                const std::map<std::string, std::string>& options, const PageMapping* page);
  /// Closes the socket, so that the helper commands zero and ends. Waits for the end of the
  /// process, and kills it after five seconds.
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  /// Receives the next message, and waits for it at most until `deadline`.
  Received receive(LocalTime deadline) { return receiveMessage(socket_, deadline); }
  /// Ends the process as the destructor does. Returns the kind of its end, for a line to the user:
  /// "signal 11 (Segmentation fault)", "exit code 1".
  std::string end();

 private:
  pid_t pid_ = -1;
  int socket_ = -1;
};

}  // namespace hapticast::client
