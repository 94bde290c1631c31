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

Recorder::~Recorder() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
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

RecorderCounts Recorder::counts() const {
  const std::lock_guard lock(mutex_);
  return {counts_.written, counts_.lost + dropped_};
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
    std::size_t begin = 0;
    for (const Waiting& each : batch.messages) {
      writer_.write(each.channel, each.time_ns,
                    std::span(batch.bytes).subspan(begin, each.end - begin));
      begin = each.end;
    }
    batch.messages.clear();
    batch.bytes.clear();
    if (ended) writer_.finish();
    if (clock.now() - flushed >= kFlushEvery) {
      writer_.flush();
      flushed = clock.now();
    }
    {
      const std::lock_guard lock(mutex_);
      counts_ = {writer_.written(), writer_.lost()};
    }
    if (counts().lost > reported_ && lines.allow(clock.now())) reportLost();
  }
}

void Recorder::reportLost() {
  const std::uint64_t lost = counts().lost;
  report_(file_ + ": " + std::to_string(lost - reported_) + " messages are lost (" +
          (writer_.problem().empty() ? "the disk is too slow" : writer_.problem()) + ")");
  reported_ = lost;
}

}  // namespace hapticast
