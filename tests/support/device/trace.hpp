// SPDX-License-Identifier: MIT
// The trace of a stand-in device, seen from the test: a file that outlives all processes.
// Thread: one.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "tests/support/device/standin.h"

namespace hapticast::testing {

class Trace {
 public:
  /// Creates the file and maps it.
  explicit Trace(const std::string& file) : file_(file) {
    std::ofstream(file, std::ios::binary) << std::string(sizeof(standin_trace), '\0');
    const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC);
    trace_ = static_cast<standin_trace*>(
        mmap(nullptr, sizeof(standin_trace), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0));
    close(descriptor);
  }
  ~Trace() { munmap(trace_, sizeof(standin_trace)); }
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;
  standin_trace* operator->() const { return trace_; }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  std::string file_;
  standin_trace* trace_;
};

}  // namespace hapticast::testing
