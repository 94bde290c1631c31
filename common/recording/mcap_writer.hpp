// SPDX-License-Identifier: MIT
// Writes a file in the format MCAP (mcap_records.hpp). Messages collect in a chunk of 1 MiB, which
// is not compressed. A program that is killed can cut off the last chunk only. If the disk is full,
// the chunk is lost and the file keeps its length. The writer tries the next chunk again. It never
// throws for a lack of memory: the chunk is lost then, too. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/recording/mcap_records.hpp"

namespace hapticast {

/// An MCAP file that grows.
class McapWriter {
 public:
  /// Bytes of a chunk after which it is written. The usual size of other writers.
  static constexpr std::size_t kChunkBytes = 1U << 20U;

  /// Creates `file` and writes its head with the channels; the number of a channel is its place in
  /// `channels`. Throws std::runtime_error with one line without the file's name if `file` exists
  /// or cannot be written.
  McapWriter(const std::string& file, const std::vector<McapChannel>& channels);
  /// Writes the rest as finish() does.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Adds a message. `time_ns`: time of its content on the clock of the file. Requires `channel` <
  /// the number of channels, and data of less than 4 GiB.
  void write(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// Writes the messages that wait to the file.
  void flush();
  /// Writes the messages that wait and the summary, and closes the file. Returns whether the
  /// summary is in the file. A second call does nothing.
  bool finish();
  /// Closes the file without the summary. The messages that wait, and all later ones, are lost.
  void abandon();

  /// Returns the number of messages in the file.
  [[nodiscard]] std::uint64_t written() const { return written_; }
  /// Returns the number of messages that the file system refused, or that abandon() lost.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// Returns the last answer of the file system if it refused bytes, such as "No space left on
  /// device"; empty if all were written.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  /// Place and time of a message in its chunk.
  struct Place {
    std::uint64_t time_ns;
    std::uint64_t offset;
  };
  void writeHead(McapOut& out) const;
  [[nodiscard]] std::vector<std::uint8_t> makeSummary() const;
  /// Appends the record of the open chunk to `out`, and the indexes of its messages.
  void appendChunk(std::vector<std::uint8_t>& out);
  void add(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// Writes the open chunk. Returns success.
  bool writeChunk();
  void clearChunk();
  void close();
  /// Appends `bytes` to the file as a whole, or leaves the file unchanged. Returns success.
  bool append(std::span<const std::uint8_t> bytes);

  std::vector<McapChannel> channels_;
  int file_ = -1;
  std::uint64_t size_ = 0;                   // bytes of the file
  std::vector<std::uint8_t> chunk_;          // records of the open chunk
  std::vector<std::vector<Place>> places_;   // by channel, in the open chunk
  std::vector<std::uint8_t> chunk_indexes_;  // records for the summary
  std::vector<std::uint64_t> counts_;        // messages in the file, by channel
  std::uint64_t chunk_messages_ = 0;
  std::uint64_t chunk_begin_ns_ = 0, chunk_end_ns_ = 0;
  std::uint64_t begin_ns_ = 0, end_ns_ = 0;
  std::uint32_t chunk_count_ = 0;
  std::uint32_t sequence_ = 0;
  bool has_summary_ = false;
  std::uint64_t written_ = 0, lost_ = 0;
  std::string problem_;
};

}  // namespace hapticast
