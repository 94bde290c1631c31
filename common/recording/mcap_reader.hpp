// SPDX-License-Identifier: MIT
// Reads a file in the format MCAP (mcap_records.hpp), whose bytes are not trusted. The places of
// the chunks come from the summary at the end of the file. A file without a summary, such as one
// that was cut off, is scanned: all its chunks up to the first damage count. Messages come in the
// order of the file, one chunk in memory at a time. A scan also finds messages outside of chunks;
// with a summary they are left out. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/recording/mcap_file.hpp"
#include "common/recording/mcap_records.hpp"
#include "common/result.hpp"

namespace hapticast {

/// A message of a file. `data` is valid until the next call of the reader.
struct McapMessage {
  std::uint16_t channel = 0;
  std::uint64_t time_ns = 0;
  std::span<const std::uint8_t> data;
};

/// Place of a message in a file, for McapReader::seek().
struct McapPlace {
  std::size_t block = 0;  ///< number of its chunk, or of its run of records outside of chunks
  std::size_t at = 0;     ///< place of its record in the block, bytes
  bool operator==(const McapPlace&) const = default;
};

/// Receives the share of a file that is read, 0 to 1, each time before a chunk or another record.
using ReadProgress = std::function<void(double share)>;

/// An MCAP file that is open for reading.
class McapReader {
 public:
  /// Opens `file`. Returns an error without the file's name ("is no MCAP file") if it cannot be
  /// read, or has no whole message. `most_blocks`: a file without a summary is scanned up to so
  /// many chunks. One is enough for the first channels. `progress` receives how far the scan is; it
  /// may be empty.
  [[nodiscard]] static Result<McapReader> open(
      const std::string& file, const ReadProgress& progress = {},
      std::size_t most_blocks = std::numeric_limits<std::size_t>::max());
  /// Returns another reader of the same file, at its begin, without reading it again. Both share
  /// the index and the chunks that they read at the same time, so they belong to one thread.
  /// Returns an error if the system has no handle for the file.
  [[nodiscard]] Result<McapReader> reopen() const;

  /// Returns the channels, by their number in messages. The data of their schemas are left out.
  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const { return channels_; }
  /// Returns the time of the last message.
  [[nodiscard]] std::uint64_t end_ns() const { return end_ns_; }

  /// Returns the next message. Returns nullopt at the end, and at the first damage (problem()).
  [[nodiscard]] std::optional<McapMessage> next();
  /// Returns the share of the chunks that next() has begun, 0 to 1.
  [[nodiscard]] double share() const {
    return static_cast<double>(next_block_) / static_cast<double>(shared_->blocks.size());
  }
  /// Continues with the first chunk that has a message of `time_ns` or later. Earlier messages of
  /// that chunk come, too.
  void seek(std::uint64_t time_ns);
  /// Returns the place of the message that next() returned last.
  [[nodiscard]] McapPlace place() const { return {next_block_ - 1, message_at_}; }
  /// Continues with the message at `place`. Requires a place of a reader of the same file.
  void seek(McapPlace place);
  /// Returns why the messages end before the end of the file, as a phrase such as "is cut off";
  /// empty: they do not, or the end was not reached.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  /// A chunk, or a run of records outside of chunks.
  struct Block {
    std::uint64_t offset;  ///< of its record, or of its first record
    std::uint64_t bytes;
    std::uint64_t begin_ns, end_ns;
    bool is_chunk;
  };
  using Records = std::vector<std::uint8_t>;
  /// What the readers of one file share: the index of a day has 86,400 chunks.
  struct Shared {
    std::vector<Block> blocks;                                   // constant once the file is open
    std::map<std::size_t, std::weak_ptr<const Records>> loaded;  // of readers at the same place
  };
  explicit McapReader(McapFile file) : file_(std::move(file)) {}
  [[nodiscard]] std::vector<std::uint8_t> readBytes(std::uint64_t offset,
                                                    std::uint64_t bytes) const;
  /// Reads the summary. Returns false if there is none that can be used.
  [[nodiscard]] bool readSummary();
  [[nodiscard]] bool readChunkIndex(std::span<const std::uint8_t> content);
  /// Returns the records of the summary, or nothing if there is none with a correct checksum.
  [[nodiscard]] std::vector<std::uint8_t> readSummaryBytes() const;
  /// Finds the blocks without a summary, and the damage that ends them.
  void scan(const ReadProgress& progress, std::size_t most_blocks);
  void scanRun(std::uint64_t begin, std::uint64_t end);
  void scanChunk(std::uint64_t begin, std::uint64_t end);
  /// Adds the block with these records, up to the first damage. Its times are those of its
  /// messages.
  void addBlock(std::uint64_t offset, std::uint64_t bytes, bool is_chunk,
                std::span<const std::uint8_t> records);
  void readDefinition(const McapRecord& record);
  /// Makes block_ the block `index`. Returns success.
  bool load(std::size_t index);
  /// Returns the records of the block `index`; null: problem_ says why.
  [[nodiscard]] std::shared_ptr<const Records> readBlock(std::size_t index);

  McapFile file_;
  std::map<std::uint16_t, McapSchema> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  std::uint64_t end_ns_ = 0;
  std::string damage_;  // found by scan(), behind the last block
  std::string problem_;
  std::size_t next_block_ = 0;
  std::shared_ptr<const Records> block_ = std::make_shared<Records>();  // the present one
  std::size_t at_ = 0;          // place of the next record in block_
  std::size_t message_at_ = 0;  // place of the last message in block_
};

}  // namespace hapticast
