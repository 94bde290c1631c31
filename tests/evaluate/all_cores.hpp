// SPDX-License-Identifier: MIT
// Work that the cores share.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hapticast::evaluate {

/// Runs job(0) .. job(count - 1) on all cores, begun in this order; each writes only what is its
/// own. A core whose job throws ends; the last exception is thrown when all have ended.
template <class Job>
void onAllCores(std::size_t count, Job job) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
      workers.emplace_back([&] {
        try {
          for (std::size_t at = next++; at < count; at = next++) job(at);
        } catch (...) {
          const std::lock_guard lock(mutex);
          error = std::current_exception();
        }
      });
    }
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace hapticast::evaluate
