// SPDX-License-Identifier: MIT
#include "client/haptics/loop_thread.hpp"

namespace hapticast::client {

LoopThread::LoopThread(HapticDevice& device, HapticRenderer& renderer, const Clock& clock)
    : thread_([this, &device, &renderer, &clock] {
        realtime_ = requestRealtime();
        flushDenormals();
        runLoop(device, renderer, clock, stop_, stats_);
      }) {}

void LoopThread::stop() noexcept {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace hapticast::client
