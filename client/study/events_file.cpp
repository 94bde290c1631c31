// SPDX-License-Identifier: MIT
#include "client/study/events_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr const char* kAbsent = "n/a";
constexpr std::size_t kColumns = 12;

// 17 digits: --resume compares levels, so the text has to be exact.
std::string toField(const std::optional<double>& value) {
  return value ? fmt::format("{:.17g}", *value) : kAbsent;
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

/// Reads the fields of a line.
class Fields {
 public:
  explicit Fields(std::string_view line) {
    while (count_ < kColumns) {
      const std::size_t end = line.find('\t');
      fields_[count_++] = line.substr(0, end);
      if (end == std::string_view::npos) return;
      line.remove_prefix(end + 1);
    }
    ok_ = false;  // more fields than columns
  }
  std::string_view next() { return fields_[next_++]; }
  std::optional<double> number() {
    const std::string_view field = next();
    if (field == kAbsent) return std::nullopt;
    const auto number = parseNumber(field);
    ok_ = ok_ && number.has_value();
    return number;
  }
  double required() {
    const auto number = this->number();
    ok_ = ok_ && number.has_value();
    return number.value_or(0.0);
  }
  void require(bool ok) { ok_ = ok_ && ok; }
  [[nodiscard]] bool ok() const { return ok_ && count_ == kColumns; }

 private:
  std::array<std::string_view, kColumns> fields_;
  std::size_t count_ = 0, next_ = 0;
  bool ok_ = true;
};

std::string makeHeader() {
  std::string header;
  for (const EventColumn& column : listEventColumns())
    header.append(header.empty() ? "" : "\t").append(column.name);
  return header + "\n";
}

}  // namespace

const std::vector<EventColumn>& listEventColumns() {
  static const std::vector<EventColumn> columns{
      {"onset", "Start of the trial since the first row of the motion file"},
      {"duration", "Time from the onset to the answer"},
      {"trial_type", "training: the answer does not count; main: it counts"},
      {"trial", "Number of the trial of this subject, from 1"},
      {"condition", "Code of the condition"},
      {"comparison_interval", "Interval with the reference plus the level, 1 or 2"},
      {"level", "Difference between the two intervals, in the unit of the study's variable"},
      {"answer", "Answer: the interval, the step of the scale, or 0 to 100"},
      {"is_correct", "1: the answer names the interval with the larger value; 0: the other one"},
      {"response_time", "Time from the question to the answer"},
      {"status", "valid, or why the trial is void: stopped, device_lost, stream_lost, trust_lost"},
      {"wall_clock", "Time of the onset, UTC"}};
  return columns;
}

std::string toLine(const TrialRow& row) {
  const auto flag = [](const std::optional<bool>& value) {
    return value ? std::optional<double>(*value ? 1.0 : 0.0) : std::nullopt;
  };
  return fmt::format("{:.6f}\t{:.6f}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\n", row.onset_s,
                     row.duration_s, row.is_training ? "training" : "main", row.trial,
                     row.condition, toField(row.comparison_interval), toField(row.level),
                     toField(row.answer), toField(flag(row.is_correct)),
                     toField(row.response_time_s), row.status, row.wall_clock);
}

Result<TrialRow> parseRow(std::string_view line) {
  Fields fields(line);
  TrialRow row;
  row.onset_s = fields.required();
  row.duration_s = fields.required();
  const std::string_view type = fields.next();
  row.is_training = type == "training";
  fields.require(row.is_training || type == "main");
  const double trial = fields.required();
  fields.require(trial >= 1.0 && trial <= 1e9 && trial == std::floor(trial));
  if (fields.ok()) row.trial = static_cast<std::size_t>(trial);
  row.condition = fields.next();
  const auto interval = fields.number();
  fields.require(!interval || *interval == 1.0 || *interval == 2.0);
  if (interval) row.comparison_interval = *interval == 1.0 ? 1 : 2;
  row.level = fields.number();
  row.answer = fields.number();
  const auto correct = fields.number();
  fields.require(!correct || *correct == 0.0 || *correct == 1.0);
  if (correct) row.is_correct = *correct == 1.0;
  row.response_time_s = fields.number();
  row.status = fields.next();
  row.wall_clock = fields.next();
  fields.require((row.status == "valid") == row.answer.has_value());
  if (!fields.ok()) return Error{"is no row of a trial"};
  return row;
}

EventsFile::EventsFile(const std::filesystem::path& file, bool resume) : file_(file) {
  const int flags = O_RDWR | O_CLOEXEC | O_APPEND | (resume ? 0 : O_CREAT | O_EXCL);
  descriptor_ = ::open(file.c_str(), flags, 0644);
  if (descriptor_ < 0 && errno == EEXIST)
    fail(file, "this subject has begun the study; continue with --resume");
  if (descriptor_ < 0 && errno == ENOENT && resume)
    fail(file, "this subject has not begun the study; start without --resume");
  if (descriptor_ < 0) fail(file, std::string("cannot be written (") + std::strerror(errno) + ")");
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) fail(file, "another client runs this study");
    restore();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

EventsFile::~EventsFile() { ::close(descriptor_); }

void EventsFile::restore() {
  std::ifstream in(file_, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::size_t complete = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  if (complete < text.size() && ::ftruncate(descriptor_, static_cast<off_t>(complete)) != 0)
    fail(file_, "its incomplete last row cannot be removed");
  text.resize(complete);
  const std::string header = makeHeader();
  if (text.empty()) return write(header);
  if (!text.starts_with(header)) fail(file_, "has other columns than this version writes");
  for (std::size_t begin = header.size(); begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    const auto row = parseRow(std::string_view(text).substr(begin, end - begin));
    if (!row.ok()) fail(file_, fmt::format("row {} {}", rows_.size() + 1, row.error().message));
    rows_.push_back(row.value());
    begin = end + 1;
  }
}

void EventsFile::append(const TrialRow& row) { write(toLine(row)); }

void EventsFile::write(std::string_view text) {
  const ssize_t written = ::write(descriptor_, text.data(), text.size());
  if (written != static_cast<ssize_t>(text.size()) || ::fdatasync(descriptor_) != 0)
    fail(file_, std::string("cannot be written (") +
                    (written >= 0 ? "the disk is full" : std::strerror(errno)) +
                    "); free some space, then continue with --resume");
}

}  // namespace hapticast::client
