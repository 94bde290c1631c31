// SPDX-License-Identifier: MIT
#include "server/show/bake/baked_file.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/protocol/recorded.hpp"
#include "common/recording/mcap_reader.hpp"
#include "common/recording/progress_log.hpp"
#include "common/recording/recorder.hpp"
#include "common/recording/schemas.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::server {

namespace {

enum BakedChannel : std::size_t { kLog, kDescription, kFrame, kPicture };
constexpr std::size_t kChannels = kPicture + 1;

std::vector<McapChannel> makeChannels() {
  return {makeChannel("/log", "foxglove.Log"),
          makeChannel("/description", "hapticast.proto.StreamDescription", true),
          makeChannel("/frame", "hapticast.proto.HapticFrame"),
          makeChannel("/picture", "foxglove.CompressedImage")};
}

std::vector<std::uint8_t> makeFirstLine(const std::string& fingerprint) {
  return encodeLogContent(0, LogLevel::kInfo, fingerprint, "hapticast-server");
}

std::uint64_t toTime(MediaTime time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
}

/// A copy of a message.
struct Message {
  std::size_t channel;
  std::uint64_t time_ns;
  std::vector<std::uint8_t> data;
};

/// Reads the messages of a .part, block by block.
class PartReader {
 public:
  PartReader(McapReader file, std::uint64_t block) : file_(std::move(file)), block_(block) {}

  [[nodiscard]] std::optional<Message> next() {
    const auto message = file_.next();
    if (!message || message->channel == 0 || message->channel > kChannels) return std::nullopt;
    return Message{message->channel - std::size_t{1},
                   message->time_ns,
                   {message->data.begin(), message->data.end()}};
  }
  /// Returns the messages of the next block; empty: it is not whole.
  [[nodiscard]] std::vector<Message> nextBlock() {
    std::vector<Message> out;
    for (std::uint64_t pictures = 0; pictures < block_;) {  // a frame ends with its picture
      auto message = next();
      if (!message) return {};
      pictures += message->channel == kPicture ? 1U : 0U;
      out.push_back(std::move(*message));
    }
    return out;
  }

 private:
  McapReader file_;
  std::uint64_t block_;
};

}  // namespace

BakedFile::BakedFile(const std::string& file, const std::string& fingerprint, std::uint64_t block,
                     bool resume)
    : file_(file), part_(file + ".part"), block_(block) {
  std::error_code error;
  if (std::filesystem::exists(file_, error))
    throw RecordingError("-o " + file_ + ": exists; delete it, or name another file");
  const bool has_part = std::filesystem::exists(part_, error);
  if (has_part && !resume)
    throw RecordingError("-o " + file_ + ": " + part_ +
                         " is of an interrupted bake; continue it with --resume, or delete it");
  try {
    if (has_part) {
      keepBlocks(fingerprint);
    } else {
      writer_.emplace(part_, makeChannels());
      writer_->write(kLog, 0, makeFirstLine(fingerprint));
      writer_->flush();
    }
  } catch (const RecordingError&) {
    throw;
  } catch (const std::runtime_error& problem) {
    throw RecordingError("-o " + file_ + ": " + problem.what());
  }
  requireWritten();
}

BakedFile::~BakedFile() {
  writer_.reset();
  std::error_code error;
  if (frames_ == 0) std::filesystem::remove(part_, error);
}

// Copies the whole blocks into a new file, which then replaces the .part: a writer cannot continue
// a file.
void BakedFile::keepBlocks(const std::string& fingerprint) {
  auto opened = McapReader::open(part_, logScan(part_));
  if (!opened.ok())
    throw RecordingError("--resume: " + part_ + " " + opened.error().message + "; delete it");
  PartReader part(std::move(opened).value(), block_);
  const std::vector<std::uint8_t> first_line = makeFirstLine(fingerprint);
  const auto first = part.next();
  if (!first || first->channel != kLog || first->data != first_line)
    throw RecordingError("--resume: " + part_ +
                         " is of another clip, of other flags or of another version; delete it, or "
                         "give the same flags");
  const std::string copy = file_ + ".resumed";
  std::error_code error;
  std::filesystem::remove(copy, error);  // of a bake that was killed here
  writer_.emplace(copy, makeChannels());
  writer_->write(kLog, 0, first_line);
  writer_->flush();
  for (auto block = part.nextBlock(); !block.empty(); block = part.nextBlock()) {
    for (const Message& message : block)
      writer_->write(message.channel, message.time_ns, message.data);
    writer_->flush();
    frames_ += block_;
  }
  requireWritten();
  std::filesystem::rename(copy, part_);
}

void BakedFile::add(const StreamDescription& description, const HapticFrame& frame,
                    const SliceSettings& slices, std::vector<std::uint8_t> jpeg) {
  const std::uint64_t time_ns = toTime(frame.media_time);
  if (beginsBlock()) {
    encoder_ = FrameEncoder();
    writer_->write(kDescription, time_ns, findContent(encode(description)));
  }
  const SharedBytes bytes = encoder_.encode(frame, slices, nullptr, false).delta;
  if (bytes->size() > kMaxMessageBytes)
    throw std::runtime_error("a frame is too large for a viewer; use a smaller picture");
  writer_->write(kFrame, time_ns, findContent(*bytes));
  writer_->write(kPicture, time_ns,
                 encodePictureContent({frame.epoch, frame.id, frame.media_time, std::move(jpeg)}));
  ++frames_;
  if (beginsBlock()) writer_->flush();
  requireWritten();
}

void BakedFile::requireWritten() const {
  if (!writer_->problem().empty())
    throw std::runtime_error("-o " + file_ + ": cannot be written (" + writer_->problem() +
                             "); --resume continues");
}

void BakedFile::finish() {
  const bool complete = writer_->finish();
  requireWritten();
  if (!complete) throw std::runtime_error("-o " + file_ + ": cannot be completed");
  std::filesystem::rename(part_, file_);
}

}  // namespace hapticast::server
