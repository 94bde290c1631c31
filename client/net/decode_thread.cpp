// SPDX-License-Identifier: MIT
#include "client/net/decode_thread.hpp"

#include <utility>

namespace hapticast::client {

void DecodeThread::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void DecodeThread::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void DecodeThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (preparer_.holdsBack()) {
      waitForSlot();
      continue;
    }
    std::unique_lock lock(mutex_);
    something_waits_.wait(lock, stop, [this] { return !queue_.empty(); });
    const auto accepted = queue_.pop();
    lock.unlock();
    if (accepted) preparer_.prepare(*accepted);
  }
}

void DecodeThread::waitForSlot() {
  constexpr auto kMoment = std::chrono::milliseconds(2);  // chosen: far below a frame interval
  const LocalTime begin = clock_.now();
  std::this_thread::sleep_for(kMoment);
  const std::lock_guard lock(mutex_);
  queue_.holdBack(clock_.now() - begin);
}

void DecodeThread::reset(const Workspace& workspace) {
  const std::lock_guard lock(mutex_);
  queue_.reset(workspace);
}

std::size_t DecodeThread::push(AssembledFrame assembled) {
  std::size_t left_out = 0;
  {
    const std::lock_guard lock(mutex_);
    left_out = queue_.push(std::move(assembled));
  }
  something_waits_.notify_one();
  return left_out;
}

}  // namespace hapticast::client
