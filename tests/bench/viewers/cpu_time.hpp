// SPDX-License-Identifier: MIT
// Computing time of another process so far, thread by thread, as the kernel counts it. Thread: any.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "common/time.hpp"

namespace hapticast::testing {

struct ThreadTime {
  Duration run{0};                 ///< on a processor, ns
  std::uint64_t system_ticks = 0;  ///< of it in the kernel, in the kernel's coarse ticks
};
using ProcessTime = std::map<std::string, ThreadTime>;  // by thread id

/// Nothing where there is no such process.
inline ProcessTime processTime(pid_t pid) {
  ProcessTime times;
  std::error_code ec;
  const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(tasks, ec)) {
    ThreadTime time;
    std::int64_t run_ns = 0;
    std::ifstream(task.path() / "schedstat") >> run_ns;
    time.run = Duration(run_ns);
    std::ifstream file(task.path() / "stat");
    std::string line;
    std::getline(file, line);
    // The name, in brackets, may hold anything; system time is the 13th word behind it.
    std::istringstream words(line.substr(std::min(line.rfind(')') + 1, line.size())));
    std::string word;
    for (int i = 0; i < 12; ++i) words >> word;
    words >> time.system_ticks;
    times[task.path().filename().string()] = time;
  }
  return times;
}

/// Memory of the process that is in use.
inline double residentBytes(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  double pages = 0.0;
  file >> pages >> pages;  // the second number
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

struct CpuUsed {
  Duration network{0};  ///< the thread that was longest in the kernel: the one that sends
  Duration process{0};

  CpuUsed& operator+=(const CpuUsed& other) {
    network += other.network;
    process += other.process;
    return *this;
  }
};

inline CpuUsed used(const ProcessTime& before, const ProcessTime& after) {
  CpuUsed used;
  std::uint64_t most_ticks = 0;
  for (const auto& [id, time] : after) {
    const auto found = before.find(id);
    const ThreadTime from = found == before.end() ? ThreadTime{} : found->second;
    const Duration run = time.run - from.run;
    const std::uint64_t ticks = time.system_ticks - from.system_ticks;
    used.process += run;
    if (ticks < most_ticks || (ticks == most_ticks && run < used.network)) continue;
    most_ticks = ticks;
    used.network = run;
  }
  return used;
}

}  // namespace hapticast::testing
