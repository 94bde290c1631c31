// SPDX-License-Identifier: MIT
// Reads the stream of a recording (proto/recording.md): descriptions, frames and pictures. The
// bytes are not trusted; the decoder of the wire checks them. A recorded frame leaves out the
// reliefs that did not change. The reader adds them, so its frames have all reliefs. Thread: one.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "common/codec/coded_frame.hpp"
#include "common/protocol/messages.hpp"
#include "common/recording/typed_reader.hpp"
#include "common/result.hpp"

namespace hapticast {

/// An item of a recorded stream. Of a picture only media time and JPEG are known.
using RecordedItem = std::variant<StreamDescription, CodedFrame, VideoFrame>;

/// A recorded stream.
class StreamReader {
 public:
  /// Opens `file`. Returns an error without the file's name ("is no MCAP file") if it is no
  /// recording of a stream, or has no frame. Calls `progress` as McapReader::open() does.
  [[nodiscard]] static Result<StreamReader> open(const std::string& file,
                                                 const ReadProgress& progress = {});

  /// Returns another reader of the same file, at its begin, as McapReader::reopen() does.
  [[nodiscard]] Result<StreamReader> reopen() const;

  /// Returns the description of the first frame.
  [[nodiscard]] const StreamDescription& description() const { return first_description_; }
  /// Returns the media time of the first frame.
  [[nodiscard]] MediaTime begin() const { return begin_; }
  /// Returns the time from the first to the last frame.
  [[nodiscard]] Duration length() const { return end_ - begin_; }

  /// Returns the next item; nullopt at the end, or at the first damage (problem()). Frames rise in
  /// media time. A description comes only if it differs from the one before.
  [[nodiscard]] std::optional<RecordedItem> next();
  /// Continues with the first frame at `time` or later.
  void seek(MediaTime time);
  /// Returns why the items end early, as a phrase; empty: they do not.
  [[nodiscard]] const std::string& problem() const { return file_.problem(); }
  /// Returns the number of frames that were left out because their times run back.
  [[nodiscard]] std::uint64_t leftOut() const { return left_out_; }

 private:
  explicit StreamReader(TypedReader<RecordedItem> file) : file_(std::move(file)) {}
  /// Returns the media time of the last frame. Other messages may come after it.
  [[nodiscard]] MediaTime findEnd();
  /// Adds what a frame leaves out. Returns whether the item is one to return.
  [[nodiscard]] bool accept(RecordedItem& item);
  [[nodiscard]] bool accept(CodedFrame& frame);
  /// Adds the reliefs that the frame leaves out, where they are known.
  void complete(CodedFrame& frame);

  TypedReader<RecordedItem> file_;
  StreamDescription first_description_;
  std::optional<StreamDescription> description_;
  MediaTime begin_{}, end_{};      // of the first and the last frame
  std::optional<MediaTime> last_;  // of the last frame
  std::optional<MediaTime> from_;  // items before it only complete the frames
  struct Known {
    std::uint64_t changed_in_frame;
    std::shared_ptr<const CodedRelief> relief;
  };
  std::map<ObjectKey, Known> reliefs_;
  std::uint64_t left_out_ = 0;
};

}  // namespace hapticast
