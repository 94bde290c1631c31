// SPDX-License-Identifier: MIT
// Outputs of a program's messages: a recording (--record), watchers (--live), or both. It adds the
// channel /log with the lines of the program's log. Thread: see each function.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/live/live_server.hpp"
#include "common/live/log_tap.hpp"
#include "common/live/output_settings.hpp"
#include "common/recording/recorder.hpp"
#include "common/time.hpp"

namespace hapticast {

/// The outputs of one program.
class MessageOutputs {
 public:
  /// Creates the file and opens the port. `name`: of the program. `warning`: what the messages
  /// contain of people, for the log. `now_ns` returns the time of a line of the log, from any
  /// thread. Throws RecordingError, AddressError or std::runtime_error with one line.
  MessageOutputs(const OutputSettings& settings, const std::string& name,
                 const std::string& warning, std::vector<McapChannel> channels,
                 std::function<std::uint64_t()> now_ns);
  /// Completes the file, and logs that or how many messages are lost.
  ~MessageOutputs();
  /// Completes the file, and logs that. Throws RecordingError if it is not complete. Afterwards
  /// the object does nothing. Requires that no other thread uses it.
  void finish();
  MessageOutputs(const MessageOutputs&) = delete;
  MessageOutputs& operator=(const MessageOutputs&) = delete;

  /// Passes a message on. Never waits for disk or network. Thread: any.
  void push(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// Returns whether any output uses a message of this channel. Thread: any.
  [[nodiscard]] bool isWanted(std::size_t channel) const {
    return recorder_ || (live_ && live_->isWanted(channel));
  }

 private:
  void openRecorder(const std::vector<McapChannel>& channels);

  const std::string file_;
  const SteadyClock clock_;
  std::unique_ptr<Recorder> recorder_;  // null: no recording
  std::unique_ptr<LiveServer> live_;    // null: no watchers
  std::optional<LogTap> log_;
};

}  // namespace hapticast
