// SPDX-License-Identifier: MIT
#include "common/recording/recorder.hpp"

#include <algorithm>
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
                   std::function<void(const std::string&)> report, const Clock& clock)
    : file_(file),
      report_(std::move(report)),
      clock_(clock),
      writer_(file, channels),
      thread_([this] { run(); }) {}

std::string Recorder::finish() {
  {
    const std::lock_guard lock(mutex_);
    if (!ended_at_) ended_at_ = clock_.now();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (lost() > 0)
    return "lacks " + std::to_string(lost()) + " messages (" + describeProblem() + ")";
  return is_complete_ ? "is complete" : "has no index (" + describeProblem() + "), but can be read";
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
  LocalTime flushed = clock_.now();
  Batch batch;
  for (bool ended = false; !ended;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kFetchEvery, [this] { return ended_at_.has_value(); });
      ended = ended_at_.has_value();
      std::swap(batch, waiting_);
    }
    write(batch);
    if (ended || clock_.now() - flushed >= kFlushEvery) {
      writeInTime([this] { writer_.flush(); });
      flushed = clock_.now();
    }
    if (ended) writeInTime([this] { is_complete_ = writer_.finish(); });
    bool is_ending = false;
    {
      const std::lock_guard lock(mutex_);
      refused_ = writer_.lost();
      is_ending = ended_at_.has_value();  // finish() returns the losses then
    }
    if (!is_ending && lost() > reported_ && lines.allow(clock_.now())) reportLost();
  }
}

void Recorder::write(Batch& batch) {
  std::size_t begin = 0;
  for (const Waiting& each : batch.messages) {
    const auto data = std::span(batch.bytes).subspan(begin, each.end - begin);
    writeInTime([&] { writer_.write(each.channel, each.time_ns, data); });
    begin = each.end;
  }
  batch.messages.clear();
  batch.bytes.clear();
}

template <class Step>
void Recorder::writeInTime(Step step) {
  const LocalTime begin = clock_.now();
  std::optional<LocalTime> ended_at;
  {
    const std::lock_guard lock(mutex_);
    ended_at = ended_at_;
  }
  if (ended_at && begin + slowest_write_ > std::max(*ended_at, free_at_) + kFinishWithin)
    writer_.abandon();
  step();
  const LocalTime end = clock_.now();
  slowest_write_ = std::max(slowest_write_, end - begin);
  if (!ended_at) free_at_ = end;
}

void Recorder::reportLost() {
  const std::uint64_t count = lost();
  report_(file_ + ": " + std::to_string(count - reported_) + " messages are lost (" +
          describeProblem() + ")");
  reported_ = count;
}

std::string Recorder::describeProblem() const {
  return writer_.problem().empty() ? "the disk is too slow" : writer_.problem();
}

}  // namespace hapticast
