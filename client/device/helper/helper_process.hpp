// SPDX-License-Identifier: MIT
// Starts the program hapticast-device, and ends it. The program is in the folder of the running
// one, or in hapticast's folder for helper programs.
// Thread: one at a time.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>

#include "client/device/helper/messages.hpp"
#include "client/device/helper/shared_page.hpp"

namespace hapticast::client {

/// Returns the path of hapticast-device. Returns its bare name if the file is in no known folder.
std::string findHelperProgram();

/// One run of the helper.
class HelperProcess {
 public:
  /// Starts `program` for the driver `driver`. `task` is "list" or "open". `page` may be null for
  /// "list". Throws std::runtime_error (one line) if the program cannot be started.
  HelperProcess(const std::string& program, const std::string& driver, const char* task,
                const std::map<std::string, std::string>& options, const PageMapping* page);
  /// Closes the socket and waits until the process has ended. The helper then commands zero. Kills
  /// it after five seconds.
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  /// Receives the next message, and waits for it at most until `deadline`.
  Received receive(LocalTime deadline) { return receiveMessage(socket_, deadline); }
  /// Ends the process as the destructor does. Returns how it ended, for a line to the user:
  /// "signal 11 (Segmentation fault)", "exit code 1".
  std::string end();

 private:
  pid_t pid_ = -1;
  int socket_ = -1;
};

}  // namespace hapticast::client
