// SPDX-License-Identifier: MIT
#include "server/source/child/child_pipe.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <span>
#include <string_view>
#include <utility>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kLongestHeader = 200;     // chosen, bytes: a header has a few numbers
constexpr int kMostErrorReads = 300;            // more than a pipe holds
constexpr std::size_t kLongestErrorLine = 200;  // chosen, bytes: what fits into a message

/// Reads from a descriptor that does not block. Returns the number of bytes, 0 at the end, and
/// nullopt if there is nothing to read now.
std::optional<std::size_t> readSome(int descriptor, std::uint8_t* to, std::size_t most) {
  const ssize_t count = ::read(descriptor, to, most);
  if (count >= 0) return static_cast<std::size_t>(count);
  const bool later = errno == EAGAIN || errno == EINTR;
  return later ? std::nullopt : std::optional<std::size_t>(0);
}

/// Blocks SIGPIPE in this thread: a child that has closed its stdin is an error of write().
void blockBrokenPipeSignal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  (void)pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

}  // namespace

ChildPipe::ChildPipe(const std::string& command, MeasureAnswer measure)
    : measure_(std::move(measure)),
      process_(command),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

ChildPipe::~ChildPipe() {
  thread_.request_stop();
  (void)::eventfd_write(wake_.get(), 1);
}

void ChildPipe::push(std::vector<std::uint8_t> request) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(std::move(request));
    ++unanswered_;
  }
  (void)::eventfd_write(wake_.get(), 1);
}

std::optional<ChildAnswer> ChildPipe::pop(Duration longest) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [this] { return !answers_.empty() || !problem_.empty(); });
  if (answers_.empty()) return std::nullopt;
  ChildAnswer answer = std::move(answers_.front());
  answers_.pop_front();
  return answer;
}

std::string ChildPipe::problem() {
  const std::lock_guard lock(mutex_);
  return answers_.empty() ? problem_ : "";
}

void ChildPipe::run(const std::stop_token& stop) {
  blockBrokenPipeSignal();
  const auto works = [&] {
    const std::lock_guard lock(mutex_);
    return problem_.empty();
  };
  while (!stop.stop_requested() && works()) {
    wait();
    (void)readErrors();
    readAnswers();
    writeRequest();
  }
  (void)process_.end();
}

void ChildPipe::wait() {
  if (sent_ == sending_.size()) {
    const std::lock_guard lock(mutex_);
    sending_.clear();
    sent_ = 0;
    if (!requests_.empty()) {
      sending_ = std::move(requests_.front());
      requests_.pop_front();
    }
  }
  const short writes = sending_.empty() ? 0 : POLLOUT;
  // poll() ignores a negative descriptor.
  std::array<pollfd, 4> files{{{writes != 0 ? process_.input.get() : -1, writes, 0},
                               {process_.output.get(), POLLIN, 0},
                               {process_.errors.get(), POLLIN, 0},
                               {wake_.get(), POLLIN, 0}}};
  (void)::poll(files.data(), files.size(), -1);
  eventfd_t count = 0;
  (void)::eventfd_read(wake_.get(), &count);
}

void ChildPipe::writeRequest() {
  if (sent_ == sending_.size() || process_.input.get() < 0) return;
  const ssize_t count =
      ::write(process_.input.get(), sending_.data() + sent_, sending_.size() - sent_);
  if (count > 0) sent_ += static_cast<std::size_t>(count);
  if (count < 0 && errno != EAGAIN && errno != EINTR) fail(describeEnd());
}

bool ChildPipe::readErrors() {
  std::array<std::uint8_t, 4096> bytes{};
  const auto count = readSome(process_.errors.get(), bytes.data(), bytes.size());
  if (!count) return false;
  if (*count == 0) process_.errors.close();
  for (const std::uint8_t byte : std::span(bytes).first(*count)) {
    const bool ends = byte == '\n' || byte == '\r';
    if (!ends && error_line_.size() < kLongestErrorLine) error_line_ += static_cast<char>(byte);
    if (ends && !error_line_.empty()) last_error_line_ = std::exchange(error_line_, "");
  }
  return *count > 0;
}

void ChildPipe::readAnswers() {
  while (process_.output.get() >= 0) {
    if (!in_header_) {
      std::uint8_t* const to = receiving_.bytes.data() + received_;
      const auto count = readSome(process_.output.get(), to, receiving_.bytes.size() - received_);
      if (!count) return;
      if (*count == 0) return fail(describeEnd());
      received_ += *count;
      if (received_ == receiving_.bytes.size()) deliver();
      continue;
    }
    // One byte at a time: what follows the header belongs into receiving_.
    std::uint8_t byte = 0;
    const auto count = readSome(process_.output.get(), &byte, 1);
    if (!count) return;
    if (*count == 0) return fail(describeEnd());
    if (byte == '\n') {
      beginAnswer();
    } else {
      receiving_.header += static_cast<char>(byte);
    }
    if (receiving_.header.size() > kLongestHeader) return fail("writes no line with a header");
  }
}

void ChildPipe::beginAnswer() {
  const auto size = measure_(receiving_.header);
  if (!size) return fail("writes " + quote(receiving_.header) + ", which is no header");
  if (!countAnswer()) return fail("writes more answers than it received pictures");
  receiving_.bytes.resize(*size);
  received_ = 0;
  in_header_ = *size == 0;
  if (in_header_) deliver();
}

bool ChildPipe::countAnswer() {
  const std::lock_guard lock(mutex_);
  if (unanswered_ == 0) return false;
  --unanswered_;
  return true;
}

void ChildPipe::deliver() {
  in_header_ = true;
  {
    const std::lock_guard lock(mutex_);
    answers_.push_back(std::exchange(receiving_, {}));
  }
  changed_.notify_all();
}

void ChildPipe::fail(const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    if (problem_.empty()) problem_ = problem;
  }
  process_.output.close();
  changed_.notify_all();
}

std::string ChildPipe::describeEnd() {
  for (int i = 0; i < kMostErrorReads && readErrors(); ++i) {
  }
  const std::string end = process_.end();
  const std::string& line = error_line_.empty() ? last_error_line_ : error_line_;
  return (end.empty() ? "closes its stdout" : "ended with " + end) +
         (line.empty() ? "" : ": " + sanitizeUtf8(line));
}

}  // namespace hapticast::server
