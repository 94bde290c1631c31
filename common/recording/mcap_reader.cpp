// SPDX-License-Identifier: MIT
#include "common/recording/mcap_reader.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/recording/mcap_chunk.hpp"
#include "common/recording/mcap_compression.hpp"

namespace hapticast {

namespace {

/// Bytes of a run of records outside of chunks.
constexpr std::uint64_t kRunBytes = 1U << 20U;
/// Largest summary, bytes: that of a year with a chunk a second has 4 GiB, that of a day 10 MB.
constexpr std::uint64_t kMostSummaryBytes = 256U << 20U;
/// Longest name of a topic, a schema or an encoding that is kept, bytes.
constexpr std::size_t kMostTextBytes = 256;
constexpr std::size_t kHeadBytes = kMcapMagic.size() + kMcapRecordHeadBytes;

std::optional<McapMessage> readMessage(const McapRecord& record) {
  if (record.code != McapCode::kMessage) return std::nullopt;
  McapIn in(record.content);
  McapMessage message;
  message.channel = in.number<std::uint16_t>();
  (void)in.number<std::uint32_t>();
  message.time_ns = in.number<std::uint64_t>();
  (void)in.number<std::uint64_t>();
  message.data = in.rest();
  return in.ok() ? std::optional(message) : std::nullopt;
}

}  // namespace

Result<McapReader> McapReader::open(const std::string& file, const ReadProgress& progress,
                                    std::size_t most_blocks) {
  auto opened = McapFile::open(file);
  if (!opened.ok()) return opened.error();
  McapReader reader(std::move(opened).value());
  const auto head = reader.readBytes(0, kHeadBytes);
  if (head.size() < kHeadBytes || !std::equal(kMcapMagic.begin(), kMcapMagic.end(), head.begin()))
    return Error{"is no MCAP file"};
  if (!reader.readSummary()) reader.scan(progress, most_blocks);
  if (reader.shared_->blocks.empty())
    return Error{reader.damage_.empty() ? "has no messages"
                                        : "has no messages: it " + reader.damage_};
  for (const Block& block : reader.shared_->blocks)
    reader.end_ns_ = std::max(reader.end_ns_, block.end_ns);
  return reader;
}

Result<McapReader> McapReader::reopen() const {
  auto file = file_.reopen();
  if (!file.ok()) return file.error();
  McapReader reader(std::move(file).value());
  reader.schemas_ = schemas_;
  reader.channels_ = channels_;
  reader.shared_ = shared_;
  reader.end_ns_ = end_ns_;
  reader.damage_ = damage_;
  return reader;
}

std::vector<std::uint8_t> McapReader::readBytes(std::uint64_t offset, std::uint64_t bytes) const {
  if (offset > file_.size()) return {};
  std::vector<std::uint8_t> read(static_cast<std::size_t>(std::min(bytes, file_.size() - offset)));
  read.resize(file_.read(offset, read));
  return read;
}

bool McapReader::readSummary() {
  const auto summary = readSummaryBytes();
  McapIn in(summary);
  while (!in.rest().empty()) {
    const auto record = readRecord(in);
    if (!record) break;
    readDefinition(*record);
    if (record->code == McapCode::kChunkIndex && !readChunkIndex(record->content)) {
      shared_->blocks.clear();
      break;
    }
  }
  if (in.rest().empty() && !shared_->blocks.empty() && !channels_.empty()) return true;
  shared_->blocks.clear();
  schemas_.clear();
  channels_.clear();
  return false;
}

std::vector<std::uint8_t> McapReader::readSummaryBytes() const {
  constexpr std::uint64_t kEndBytes = kMcapFooterBytes + kMcapMagic.size();
  if (file_.size() < kHeadBytes + kEndBytes) return {};
  const std::uint64_t footer_place = file_.size() - kEndBytes;
  const auto end = readBytes(footer_place, kEndBytes);
  if (end.size() != kEndBytes ||
      !std::equal(kMcapMagic.begin(), kMcapMagic.end(), end.begin() + kMcapFooterBytes))
    return {};
  McapIn tail(end);
  const auto footer = readRecord(tail);
  if (!footer || footer->code != McapCode::kFooter) return {};
  McapIn content(footer->content);
  const auto begin = content.number<std::uint64_t>();
  (void)content.number<std::uint64_t>();
  const auto crc = content.number<std::uint32_t>();
  if (!content.ok() || begin < kHeadBytes || begin >= footer_place ||
      footer_place - begin > kMostSummaryBytes)
    return {};
  auto summary = readBytes(begin, footer_place - begin);
  // The CRC covers the footer up to its own place.
  const std::uint32_t actual =
      computeCrc32(std::span(end).first(kMcapFooterBytes - 4), computeCrc32(summary));
  if (crc != 0 && crc != actual) return {};
  return summary;
}

bool McapReader::readChunkIndex(std::span<const std::uint8_t> content) {
  McapIn in(content);
  Block block{};
  block.begin_ns = in.number<std::uint64_t>();
  block.end_ns = in.number<std::uint64_t>();
  block.offset = in.number<std::uint64_t>();
  block.bytes = in.number<std::uint64_t>();
  block.is_chunk = true;
  if (!in.ok() || block.offset < kHeadBytes || block.offset > file_.size() ||
      block.bytes > file_.size() - block.offset ||
      block.bytes > kMostChunkBytes + kMcapRecordHeadBytes || block.begin_ns > block.end_ns)
    return false;
  // Each chunk counts once.
  if (!shared_->blocks.empty() &&
      block.offset < shared_->blocks.back().offset + shared_->blocks.back().bytes)
    return false;
  shared_->blocks.push_back(block);
  return true;
}

void McapReader::scan(const ReadProgress& progress, std::size_t most_blocks) {
  std::uint64_t offset = kMcapMagic.size();
  std::uint64_t run = offset;  // begin of the records outside of chunks
  while (damage_.empty() && shared_->blocks.size() < most_blocks) {
    if (progress) progress(static_cast<double>(offset) / static_cast<double>(file_.size()));
    const auto head = readBytes(offset, kMcapRecordHeadBytes);
    McapIn in(head);
    const auto code = static_cast<McapCode>(in.number<std::uint8_t>());
    const auto length = in.number<std::uint64_t>();
    if (!in.ok() || length > file_.size() - offset - kMcapRecordHeadBytes) {
      damage_ = "is cut off";
      break;
    }
    if (code == McapCode{}) {  // such as zeros behind a loss of power
      damage_ = "is damaged";
      break;
    }
    const std::uint64_t end = offset + kMcapRecordHeadBytes + length;
    const bool is_last = code == McapCode::kDataEnd || code == McapCode::kFooter;
    if (is_last || code == McapCode::kChunk || end - run > kRunBytes) {
      scanRun(run, offset);
      run = offset;
    }
    if (is_last) return;
    if (code == McapCode::kChunk) {
      scanChunk(offset, end);
      run = end;
    }
    offset = end;
  }
  scanRun(run, offset);
}

void McapReader::scanRun(std::uint64_t begin, std::uint64_t end) {
  if (end - begin > kMostChunkBytes) {
    damage_ = "has a record of more than 256 MiB";
    return;
  }
  addBlock(begin, end - begin, false, readBytes(begin, end - begin));
}

void McapReader::scanChunk(std::uint64_t begin, std::uint64_t end) {
  const std::uint64_t content = begin + kMcapRecordHeadBytes;
  if (end - content > kMostChunkBytes) {
    damage_ = "has a chunk of more than 256 MiB";
    return;
  }
  const McapChunk chunk = readChunk(readBytes(content, end - content));
  damage_ = chunk.problem;
  if (damage_.empty()) addBlock(begin, end - begin, true, chunk.records);
}

void McapReader::addBlock(std::uint64_t offset, std::uint64_t bytes, bool is_chunk,
                          std::span<const std::uint8_t> records) {
  Block block{offset, bytes, std::numeric_limits<std::uint64_t>::max(), 0, is_chunk};
  bool any = false;
  McapIn in(records);
  while (!in.rest().empty()) {
    const auto record = readRecord(in);
    if (!record) {
      damage_ = "has a damaged chunk";
      break;
    }
    readDefinition(*record);
    const auto message = readMessage(*record);
    if (!message) continue;
    block.begin_ns = std::min(block.begin_ns, message->time_ns);
    block.end_ns = std::max(block.end_ns, message->time_ns);
    any = true;
  }
  if (any) shared_->blocks.push_back(block);
}

void McapReader::readDefinition(const McapRecord& record) {
  if (record.code != McapCode::kSchema && record.code != McapCode::kChannel) return;
  McapIn in(record.content);
  const auto id = in.number<std::uint16_t>();
  if (record.code == McapCode::kSchema) {
    const std::string_view name = in.text(), encoding = in.text();
    if (in.ok() && name.size() <= kMostTextBytes && encoding.size() <= kMostTextBytes)
      schemas_.try_emplace(id, McapSchema{std::string(name), std::string(encoding), ""});
    return;
  }
  const auto schema_id = in.number<std::uint16_t>();
  const std::string_view topic = in.text(), encoding = in.text();
  if (!in.ok() || topic.size() > kMostTextBytes || encoding.size() > kMostTextBytes) return;
  McapChannel channel{std::string(topic), std::string(encoding), {}};
  if (const auto schema = schemas_.find(schema_id); schema != schemas_.end())
    channel.schema = schema->second;
  channels_.emplace(id, std::move(channel));
}

bool McapReader::load(std::size_t index) {
  at_ = 0;
  std::weak_ptr<const Records>& loaded = shared_->loaded[index];
  block_ = loaded.lock();
  if (!block_) loaded = block_ = readBlock(index);
  std::erase_if(shared_->loaded, [](const auto& each) { return each.second.expired(); });
  if (block_) return true;
  block_ = std::make_shared<Records>();
  return false;
}

std::shared_ptr<const McapReader::Records> McapReader::readBlock(std::size_t index) {
  const Block& block = shared_->blocks[index];
  auto bytes = std::make_shared<Records>(readBytes(block.offset, block.bytes));
  if (bytes->size() != block.bytes) {
    problem_ = "cannot be read to its end";
    return nullptr;
  }
  if (!block.is_chunk) return bytes;
  McapIn in(*bytes);
  const auto record = readRecord(in);
  if (!record || record->code != McapCode::kChunk || !in.rest().empty()) {
    problem_ = "has an index that names no chunk";
    return nullptr;
  }
  McapChunk chunk = readChunk(record->content);
  problem_ = chunk.problem;
  if (!problem_.empty()) return nullptr;
  return std::make_shared<Records>(std::move(chunk.records));
}

std::optional<McapMessage> McapReader::next() {
  while (problem_.empty()) {
    McapIn in(std::span<const std::uint8_t>(*block_).subspan(at_));
    const std::size_t before = in.rest().size();
    if (const auto record = readRecord(in)) {
      message_at_ = std::exchange(at_, at_ + before - in.rest().size());
      readDefinition(*record);
      const auto message = readMessage(*record);
      if (message && channels_.contains(message->channel)) return message;
      continue;
    }
    if (at_ < block_->size()) {
      problem_ = "has a damaged chunk";
    } else if (next_block_ == shared_->blocks.size()) {
      problem_ = damage_;
      return std::nullopt;
    } else if (!load(next_block_++)) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

void McapReader::seek(std::uint64_t time_ns) {
  const auto found = std::find_if(shared_->blocks.begin(), shared_->blocks.end(),
                                  [&](const Block& block) { return block.end_ns >= time_ns; });
  next_block_ = static_cast<std::size_t>(found - shared_->blocks.begin());
  block_ = std::make_shared<Records>();
  at_ = 0;
  problem_.clear();
}

void McapReader::seek(McapPlace place) {
  problem_.clear();
  if (place.block >= shared_->blocks.size()) {
    problem_ = "cannot be read any more";
    return;
  }
  if (next_block_ != place.block + 1 || block_->empty()) {
    next_block_ = place.block + 1;
    if (!load(place.block)) return;
  }
  at_ = std::min(place.at, block_->size());
}

}  // namespace hapticast
