// SPDX-License-Identifier: MIT
// Sends requests to a child process and receives its answers. An answer is a header line and, if
// the header announces them, bytes. A thread moves the bytes, so a slow child never blocks the
// caller. The pipe fails for good if the child ends, writes something else than an answer, or
// answers without a request. Thread: one, beside the thread that it owns.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/time.hpp"
#include "server/source/child/child_process.hpp"

namespace hapticast::server {

/// One answer of the child.
struct ChildAnswer {
  std::string header;  ///< without the end of the line
  std::vector<std::uint8_t> bytes;
};

/// A child process with requests and answers.
class ChildPipe {
 public:
  /// Function that returns the number of bytes behind a header line; nullopt: it is no header. It
  /// limits the number, because the pipe allocates it. Thread: the pipe's.
  using MeasureAnswer = std::function<std::optional<std::size_t>(const std::string& header)>;

  /// Starts `command`. Throws SourceError if that is impossible.
  ChildPipe(const std::string& command, MeasureAnswer measure);
  /// Ends the child and the thread.
  ~ChildPipe();
  ChildPipe(const ChildPipe&) = delete;
  ChildPipe& operator=(const ChildPipe&) = delete;

  /// Adds a request, which has one answer. The caller limits how many requests wait.
  void push(std::vector<std::uint8_t> request);
  /// Returns the next answer. Waits for it, at most `longest`. Returns nullopt if none came, or if
  /// the pipe has failed and all answers before that were returned.
  std::optional<ChildAnswer> pop(Duration longest);
  /// Returns why the pipe failed, as a phrase; "" if it works.
  [[nodiscard]] std::string problem();

 private:
  /// The thread: moves bytes until the pipe fails or the owner stops it.
  void run(const std::stop_token& stop);
  /// Waits until a pipe or the owner has something to do.
  void wait();
  /// Writes as much of the oldest request as the child reads.
  void writeRequest();
  /// Reads what the child wrote and splits it into answers.
  void readAnswers();
  /// Returns whether there was something to read.
  bool readErrors();
  /// Begins the answer of a header line, and delivers it if it has no bytes.
  void beginAnswer();
  /// Counts an answer. Returns false if there was no request for it.
  bool countAnswer();
  void deliver();
  void fail(const std::string& problem);
  /// Describes the end of the child, with the last line that it wrote to stderr.
  std::string describeEnd();

  const MeasureAnswer measure_;
  ChildProcess process_;
  OwnedDescriptor wake_;  // an event that interrupts wait()

  // Of the thread.
  std::vector<std::uint8_t> sending_;
  std::size_t sent_ = 0;
  ChildAnswer receiving_;
  std::size_t received_ = 0;  // bytes of receiving_ so far
  bool in_header_ = true;
  std::string error_line_;       // the line of stderr that is being read
  std::string last_error_line_;  // the last line that is not empty

  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::deque<std::vector<std::uint8_t>> requests_;
  std::deque<ChildAnswer> answers_;
  std::size_t unanswered_ = 0;
  std::string problem_;

  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::server
