// SPDX-License-Identifier: MIT
// Writes a recording from a thread of its own, so that no other thread waits for the disk. Messages
// wait in memory, at most kMostWaitingBytes. If the disk is slower, the recorder drops new messages
// and counts them. It writes all messages that wait to the file once a second. The end of a
// recording has a deadline: a program with a slow disk loses messages, but does not wait for all of
// them. Thread: see each function.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/recording/mcap_writer.hpp"
#include "common/time.hpp"

namespace hapticast {

/// A recording that cannot be written or read. The message has one line with the flag, the file and
/// the remedy.
struct RecordingError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A recording that grows.
class Recorder {
 public:
  /// Memory for messages that wait. Chosen: 20 s of a stream with pictures.
  static constexpr std::size_t kMostWaitingBytes = 16U << 20U;
  /// Longest time of finish() after the write that runs then. Chosen: one more write of a disk that
  /// needs 5 s for each.
  static constexpr Duration kFinishWithin = std::chrono::seconds(6);

  /// Creates `file` as McapWriter does. `report` receives one line each time messages were lost, at
  /// most once a minute, from the recorder's thread. `clock` must outlive this object.
  Recorder(const std::string& file, const std::vector<McapChannel>& channels,
           std::function<void(const std::string&)> report, const Clock& clock);
  /// Completes the file as finish() does.
  ~Recorder() { (void)finish(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Adds a message as McapWriter::write() does. Never waits for the disk. Thread: any.
  void push(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// Writes what waits, completes the file, and ends the thread. A write that could end after
  /// kFinishWithin, because an earlier one was as slow, does not begin: the rest is lost. Returns a
  /// text for the log: "is complete", or what is missing. Thread: the owner's.
  std::string finish();
  /// Returns whether the file has all messages and its index. Call it after finish().
  [[nodiscard]] bool isComplete() const { return is_complete_ && lost() == 0; }
  /// Returns the number of messages that are lost so far, because the disk was full or too slow.
  /// Thread: any.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  /// A message that waits; its data end at `end` of the bytes.
  struct Waiting {
    std::size_t channel;
    std::uint64_t time_ns;
    std::size_t end;
  };
  struct Batch {
    std::vector<Waiting> messages;
    std::vector<std::uint8_t> bytes;
  };
  void run();
  void write(Batch& batch);
  /// Calls `step`, which writes to the file at most once. Before that it abandons the file if the
  /// step could end after the deadline.
  template <class Step>
  void writeInTime(Step step);
  void reportLost();
  /// Returns why messages are lost.
  [[nodiscard]] std::string describeProblem() const;

  std::string file_;
  std::function<void(const std::string&)> report_;
  const Clock& clock_;
  McapWriter writer_;  // used by the thread only
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Batch waiting_;              // guarded by mutex_
  std::uint64_t dropped_ = 0;  // guarded by mutex_; messages that did not fit into the memory
  std::uint64_t refused_ = 0;  // guarded by mutex_; messages that the file system refused
  std::optional<LocalTime> ended_at_;  // guarded by mutex_; time of finish()
  LocalTime free_at_{};         // used by the thread only; end of the write that runs at finish()
  Duration slowest_write_{};    // used by the thread only
  std::uint64_t reported_ = 0;  // used by the thread only
  bool is_complete_ = false;    // written by the thread, read after its end
  std::jthread thread_;         // last member: it uses all others
};

}  // namespace hapticast
