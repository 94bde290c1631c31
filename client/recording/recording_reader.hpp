// SPDX-License-Identifier: MIT
// Reads the recordings of server and client message by message (proto/recording.md), for programs
// that analyse them. The bytes are not trusted: the decoders of the wire and of run_codec.hpp check
// them. Messages come in the order of the file. Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "client/recording/run_channels.hpp"
#include "client/recording/run_codec.hpp"
#include "common/protocol/messages.hpp"
#include "common/recording/typed_reader.hpp"
#include "common/result.hpp"

namespace hapticast::client {

/// The content of a message. A frame of a server's recording has no times of reception.
using RecordedContent =
    std::variant<AssembledFrame, std::vector<TickReport>, VideoFrame, StreamDescription,
                 RecordedTiming, RecordedPreparation, RendererSettings, UserControls>;

/// Returns the types of messages: those of the channels of a run (RunChannel), and
/// kSentFrameMessages.
[[nodiscard]] TypedReader<RecordedContent>::Types listRecordedTypes();

/// Sets of types.
enum RecordedTypes : unsigned {
  kRunMessages = setOf(kRunChannels) - 1,    ///< all of a client
  kSentFrameMessages = setOf(kRunChannels),  ///< of a server
  kFrameMessages = setOf(kFrameChannel) | kSentFrameMessages,
  kTickMessages = setOf(kTickChannel),
  kPictureMessages = setOf(kPictureChannel),
  kDescriptionMessages = setOf(kDescriptionChannel),
  kTimingMessages = setOf(kTimingChannel),
  kPreparationMessages = setOf(kPreparedChannel),
  kShownMessages = kPictureMessages | kDescriptionMessages,
  /// What the stream and the loop gave.
  kStreamMessages =
      kFrameMessages | kTickMessages | kShownMessages | kTimingMessages | kPreparationMessages,
};

/// A message of a recording.
struct RecordedMessage {
  std::uint64_t time_ns = 0;  ///< media time (server) or local time (client)
  std::size_t bytes = 0;      ///< size of the message
  RecordedContent content;
};

/// A recording that is open for reading.
class RecordingReader {
 public:
  /// Opens `file`. Returns an error without the file's name if it is no recording of hapticast, or
  /// has no whole message.
  [[nodiscard]] static Result<RecordingReader> open(const std::string& file);

  /// Returns whether hapticast-client wrote the file. Otherwise hapticast-server did.
  [[nodiscard]] bool isOfClient() const { return file_.has(kTickMessages); }
  /// Returns whether the file has a channel of the set `types`.
  [[nodiscard]] bool has(unsigned types) const { return file_.has(types); }
  /// Return the times of the first of kStreamMessages and of the last message.
  [[nodiscard]] std::uint64_t begin_ns() const { return begin_ns_; }
  [[nodiscard]] std::uint64_t end_ns() const { return file_.end_ns(); }

  /// Returns the next message of the set `types`. Returns nullopt at the end, and at the first
  /// damage (problem()). Leaves out frames of a server whose media times do not rise.
  [[nodiscard]] std::optional<RecordedMessage> next(unsigned types);
  /// Continues at or before the first message of `time_ns` or later.
  void seek(std::uint64_t time_ns);
  /// Returns why the messages end before the end of the file, as a phrase; empty: they do not, or
  /// the end was not reached.
  [[nodiscard]] const std::string& problem() const { return file_.problem(); }

 private:
  explicit RecordingReader(TypedReader<RecordedContent> file) : file_(std::move(file)) {}
  /// Returns whether a server's frame follows the one before.
  [[nodiscard]] bool rises(const AssembledFrame& frame);

  TypedReader<RecordedContent> file_;
  std::uint64_t begin_ns_ = 0;
  std::optional<MediaTime> last_;  // of the last frame
};

}  // namespace hapticast::client
