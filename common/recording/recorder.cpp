// SPDX-License-Identifier: MIT
#include "common/recording/recorder.hpp"

#include <chrono>
#include <utility>

#include "common/rate_limiter.hpp"

namespace hapticast {

namespace {

// Interval in which the thread fetches the messages that wait; chosen: few wake-ups.
constexpr std::chrono::milliseconds kFetchEvery{100};
// What a program that is killed loses.
constexpr std::chrono::seconds kFlushEvery{1};

}  // namespace

Recorder::Recorder(const std::string& file, const std::vector<McapChannel>& channels,
                   std::function<void(const std::string&)> report)
    : file_(file),
      report_(std::move(report)),
      writer_(file, channels),
      thread_([this] { run(); }) {}

std::string Recorder::finish() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (lost() > 0) return "lacks " + std::to_string(lost()) + " messages";
  return is_complete_ ? "is complete" : "has no index (" + writer_.problem() + "), but can be read";
}

void Recorder::push(std::size_t channel, std::uint64_t time_ns,
                    std::span<const std::uint8_t> data) {
  const std::lock_guard lock(mutex_);
  if (waiting_.bytes.size() + data.size() > kMostWaitingBytes) {
    ++dropped_;
    return;
  }
  waiting_.bytes.insert(waiting_.bytes.end(), data.begin(), data.end());
  waiting_.messages.push_back({channel, time_ns, waiting_.bytes.size()});
}

std::uint64_t Recorder::lost() const {
  const std::lock_guard lock(mutex_);
  return refused_ + dropped_;
}

void Recorder::run() {
  RateLimiter lines = RateLimiter::makeOnceAMinute();
  const SteadyClock clock;
  LocalTime flushed = clock.now();
  Batch batch;
  for (bool ended = false; !ended;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kFetchEvery, [this] { return ended_; });
      ended = ended_;
      std::swap(batch, waiting_);
    }
    write(batch);
    if (ended) is_complete_ = writer_.finish();
    if (clock.now() - flushed >= kFlushEvery) {
      writer_.flush();
      flushed = clock.now();
    }
    {
      const std::lock_guard lock(mutex_);
      refused_ = writer_.lost();
    }
    if (lost() > reported_ && lines.allow(clock.now())) reportLost();
  }
}

void Recorder::write(Batch& batch) {
  std::size_t begin = 0;
  for (const Waiting& each : batch.messages) {
    writer_.write(each.channel, each.time_ns,
                  std::span(batch.bytes).subspan(begin, each.end - begin));
    begin = each.end;
  }
  batch.messages.clear();
  batch.bytes.clear();
}

void Recorder::reportLost() {
  const std::uint64_t count = lost();
  report_(file_ + ": " + std::to_string(count - reported_) + " messages are lost (" +
          (writer_.problem().empty() ? "the disk is too slow" : writer_.problem()) + ")");
  reported_ = count;
}

}  // namespace hapticast
