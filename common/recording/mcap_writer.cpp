// SPDX-License-Identifier: MIT
#include "common/recording/mcap_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <stdexcept>
#include <system_error>

#include "common/recording/mcap_compression.hpp"

namespace hapticast {

namespace {

std::string describeErrno() { return std::system_category().message(errno); }

}  // namespace

McapWriter::McapWriter(const std::string& file, const std::vector<McapChannel>& channels)
    : channels_(channels),
      file_(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)),
      places_(channels.size()),
      counts_(channels.size()) {
  if (file_ < 0 && errno == EEXIST)
    throw std::runtime_error("exists already: choose another name, or remove it");
  if (file_ < 0) throw std::runtime_error("cannot be written (" + describeErrno() + ")");
  std::vector<std::uint8_t> head(kMcapMagic.begin(), kMcapMagic.end());
  McapOut out(head);
  const std::size_t place = out.beginRecord(McapCode::kHeader);
  out.text("").text("hapticast");
  out.endRecord(place);
  writeHead(out);
  if (append(head)) return;
  ::close(file_);
  ::unlink(file.c_str());
  throw std::runtime_error("cannot be written (" + problem_ + ")");
}

McapWriter::~McapWriter() { finish(); }

void McapWriter::writeHead(McapOut& out) const {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto id = static_cast<std::uint16_t>(i + 1);  // 0 means that there is no schema
    out.writeSchema(id, channels_[i].schema);
    out.writeChannel(id, id, channels_[i]);
  }
}

void McapWriter::write(std::size_t channel, std::uint64_t time_ns,
                       std::span<const std::uint8_t> data) {
  if (file_ < 0) {
    ++lost_;
    return;
  }
  try {
    add(channel, time_ns, data);
  } catch (const std::bad_alloc&) {
    lost_ += chunk_messages_ + 1;
    clearChunk();
  }
  if (chunk_.size() >= kChunkBytes) flush();
}

void McapWriter::add(std::size_t channel, std::uint64_t time_ns,
                     std::span<const std::uint8_t> data) {
  if (chunk_messages_ == 0) chunk_begin_ns_ = chunk_end_ns_ = time_ns;
  chunk_begin_ns_ = std::min(chunk_begin_ns_, time_ns);
  chunk_end_ns_ = std::max(chunk_end_ns_, time_ns);
  places_[channel].push_back({time_ns, chunk_.size()});
  McapOut out(chunk_);
  const std::size_t place = out.beginRecord(McapCode::kMessage);
  out.number(static_cast<std::uint16_t>(channel + 1)).number(sequence_++);
  out.number(time_ns).number(time_ns).data(data);
  out.endRecord(place);
  ++chunk_messages_;
}

void McapWriter::flush() {
  if (chunk_messages_ == 0) return;
  const std::size_t indexed = chunk_indexes_.size();
  bool written = false;
  try {
    written = file_ >= 0 && writeChunk();
  } catch (const std::bad_alloc&) {
    problem_ = "no memory";
  }
  if (!written) {
    chunk_indexes_.resize(indexed);
    lost_ += chunk_messages_;
  }
  clearChunk();
}

bool McapWriter::writeChunk() {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(chunk_.size() + 32 * chunk_messages_ + 1024);
  appendChunk(bytes);
  if (!append(bytes)) return false;
  begin_ns_ = written_ == 0 ? chunk_begin_ns_ : std::min(begin_ns_, chunk_begin_ns_);
  end_ns_ = std::max(end_ns_, chunk_end_ns_);
  for (std::size_t i = 0; i < places_.size(); ++i) counts_[i] += places_[i].size();
  written_ += chunk_messages_;
  ++chunk_count_;
  return true;
}

void McapWriter::clearChunk() {
  for (auto& places : places_) places.clear();
  chunk_.clear();
  chunk_messages_ = 0;
}

void McapWriter::appendChunk(std::vector<std::uint8_t>& bytes) {
  McapOut out(bytes);
  std::size_t place = out.beginRecord(McapCode::kChunk);
  out.number(chunk_begin_ns_).number(chunk_end_ns_);
  out.number(std::uint64_t{chunk_.size()}).number(computeCrc32(chunk_)).text("");
  out.number(std::uint64_t{chunk_.size()}).data(chunk_);
  out.endRecord(place);
  const std::uint64_t chunk_bytes = bytes.size();
  std::vector<std::uint8_t> index_places;
  McapOut index(index_places);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].empty()) continue;
    index.number(static_cast<std::uint16_t>(i + 1)).number(size_ + bytes.size());
    place = out.beginRecord(McapCode::kMessageIndex);
    out.number(static_cast<std::uint16_t>(i + 1));
    out.number(static_cast<std::uint32_t>(places_[i].size() * sizeof(Place)));
    for (const Place& each : places_[i]) out.number(each.time_ns).number(each.offset);
    out.endRecord(place);
  }
  McapOut summary(chunk_indexes_);
  place = summary.beginRecord(McapCode::kChunkIndex);
  summary.number(chunk_begin_ns_).number(chunk_end_ns_).number(size_).number(chunk_bytes);
  summary.number(static_cast<std::uint32_t>(index_places.size())).data(index_places);
  summary.number(std::uint64_t{bytes.size() - chunk_bytes}).text("");
  summary.number(std::uint64_t{chunk_.size()}).number(std::uint64_t{chunk_.size()});
  summary.endRecord(place);
}

std::vector<std::uint8_t> McapWriter::makeSummary() const {
  std::vector<std::uint8_t> bytes;
  McapOut out(bytes);
  std::size_t place = out.beginRecord(McapCode::kDataEnd);
  out.number(std::uint32_t{0});  // no CRC of all data: each chunk has its own
  out.endRecord(place);
  const std::size_t begin = bytes.size();
  writeHead(out);
  out.data(chunk_indexes_);
  place = out.beginRecord(McapCode::kStatistics);
  const auto channels = static_cast<std::uint32_t>(channels_.size());
  out.number(written_).number(static_cast<std::uint16_t>(channels)).number(channels);
  out.number(std::uint32_t{0}).number(std::uint32_t{0});  // no attachments, no metadata
  out.number(chunk_count_).number(begin_ns_).number(end_ns_);
  out.number(static_cast<std::uint32_t>(10 * channels));
  for (std::size_t i = 0; i < channels_.size(); ++i)
    out.number(static_cast<std::uint16_t>(i + 1)).number(counts_[i]);
  out.endRecord(place);
  place = out.beginRecord(McapCode::kFooter);
  out.number(size_ + begin).number(std::uint64_t{0}).number(std::uint32_t{0});
  out.endRecord(place);
  const auto summed = std::span(bytes).subspan(begin, bytes.size() - begin - 4);
  bytes.resize(bytes.size() - 4);
  const std::uint32_t crc = computeCrc32(summed);
  out.number(crc).data(kMcapMagic);
  return bytes;
}

bool McapWriter::finish() {
  flush();
  if (file_ < 0) return has_summary_;
  try {
    has_summary_ = append(makeSummary());
  } catch (const std::bad_alloc&) {  // without a summary the file still plays
    problem_ = "no memory";
  }
  close();
  return has_summary_;
}

void McapWriter::abandon() {
  lost_ += chunk_messages_;
  clearChunk();
  close();
}

void McapWriter::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

bool McapWriter::append(std::span<const std::uint8_t> bytes) {
  const std::uint64_t before = size_;
  while (!bytes.empty()) {
    const ::ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      problem_ = describeErrno();
      // Without the cut-off chunk the file stays readable.
      const auto offset = static_cast<::off_t>(before);
      if (::ftruncate(file_, offset) != 0 || ::lseek(file_, offset, SEEK_SET) < 0) close();
      size_ = before;
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    size_ += static_cast<std::uint64_t>(count);
  }
  return true;
}

}  // namespace hapticast
