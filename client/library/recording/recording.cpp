// SPDX-License-Identifier: MIT
#include "client/include/hapticast/recording.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <stdexcept>
#include <utility>

#include "client/library/receive/frame_reader.hpp"
#include "client/library/receive/picture_pairs.hpp"
#include "client/recording/recording_reader.hpp"

namespace hapticast {

namespace {

using client::RecordingReader;

// A server repeats the description within a second, and then the reliefs within another one; the
// rest is for late frames.
constexpr std::uint64_t kRepeatWithin_ns = 2'500'000'000;

RecordingReader openRecording(const std::string& file) {
  auto opened = RecordingReader::open(file);
  if (!opened.ok()) throw std::runtime_error(file + ": " + opened.error().message);
  return std::move(opened).value();
}

std::uint64_t beforeRepeat(std::uint64_t time_ns) {
  return time_ns - std::min(time_ns, kRepeatWithin_ns);
}

std::int64_t toSigned(std::uint64_t time_ns) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min(time_ns, kMost));
}

RecordedTick exportTick(const client::TickReport& from) {
  RecordedTick to;
  to.tick = from.tick;
  to.time_s = toSeconds(from.time);
  to.play_time_s = toSeconds(from.play_time);
  to.playout_delay_s = toSeconds(from.playout_delay);
  to.reading_mm = from.inputs.reading.position_mm;
  to.hip_mm = from.hip_mm;
  to.force_N = from.force_N;
  to.static_force_N = from.static_force_N;
  to.dynamic_force_N = from.dynamic_force_N;
  to.penetration_mm = from.penetration_mm;
  to.buttons = from.inputs.reading.buttons;
  to.safety_actions = from.safety_actions;
  to.device = static_cast<std::uint8_t>(from.inputs.reading.status);
  to.lookup = static_cast<std::uint8_t>(from.lookup);
  to.fault = static_cast<std::uint8_t>(from.fault);
  to.contact = from.contact;
  to.stopping = from.inputs.stopping;
  return to;
}

/// The frames of a recording, with their pictures.
class FrameCursor {
 public:
  explicit FrameCursor(RecordingReader file)
      : file_(std::move(file)), pairs_(file_.has(client::kPictureMessages)) {
    constexpr unsigned kFirst = client::kDescriptionMessages | client::kFrameMessages;
    if (const auto first = file_.next(kFirst)) {
      if (const auto* const found = std::get_if<StreamDescription>(&first->content))
        info_ = exportInfo(*found);
    }
    file_.seek(0);
  }

  [[nodiscard]] const RecordingReader& file() const { return file_; }
  [[nodiscard]] const std::optional<StreamInfo>& info() const { return info_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }

  std::optional<Frame> next() {
    auto frame = pairs_.next();
    while (!frame && problem_.empty() && read()) frame = pairs_.next();
    if (!frame) {
      pairs_.finish();
      frame = pairs_.next();
    }
    if (!frame) return std::nullopt;
    info_ = std::move(infos_.front());
    infos_.pop_front();
    return frame;
  }
  void seek(std::uint64_t time_ns) {
    from_ns_ = time_ns;
    // A client's recording has a relief that does not change only once.
    file_.seek(file_.isOfClient() ? 0 : beforeRepeat(time_ns));
    pairs_ = client::PicturePairs(file_.has(client::kPictureMessages));
    infos_.clear();
    description_.reset();
    reader_ = {};
    problem_.clear();
  }

 private:
  /// Reads a message. Returns false at the end.
  bool read() {
    constexpr unsigned kAll =
        client::kFrameMessages | client::kPictureMessages | client::kDescriptionMessages;
    auto message = file_.next(kAll);
    if (!message) {
      problem_ = file_.problem();
      return false;
    }
    if (auto* const description = std::get_if<StreamDescription>(&message->content)) {
      description_ = std::move(*description);
    } else if (auto* const picture = std::get_if<VideoFrame>(&message->content)) {
      pairs_.add(std::move(*picture));
    } else if (auto* const frame = std::get_if<client::AssembledFrame>(&message->content)) {
      add(*frame, message->time_ns);
    }
    return true;
  }
  void add(const client::AssembledFrame& frame, std::uint64_t time_ns) {
    if (time_ns < from_ns_) {
      if (description_) reader_.skip(frame, description_->workspace);
    } else if (!description_) {
      problem_ = "has no description of the stream before its frames";
    } else {
      pairs_.add(reader_.read(frame, description_->workspace));
      infos_.push_back(exportInfo(*description_));
    }
  }

  RecordingReader file_;
  std::uint64_t from_ns_ = 0;
  std::optional<StreamDescription> description_;
  std::optional<StreamInfo> info_;
  client::FrameReader reader_;
  client::PicturePairs pairs_;
  std::deque<StreamInfo> infos_;  // of the frames in pairs_
  std::string problem_;
};

/// The ticks of a recording.
class TickCursor {
 public:
  explicit TickCursor(RecordingReader file) : file_(std::move(file)) {}

  [[nodiscard]] const std::string& problem() const { return file_.problem(); }
  std::optional<RecordedTick> next() {
    while (true) {
      for (; next_ < ticks_.size(); ++next_) {
        if (ticks_[next_].time >= from_) return exportTick(ticks_[next_++]);
      }
      auto message = file_.next(client::kTickMessages);
      if (!message) return std::nullopt;
      ticks_ = std::get<std::vector<client::TickReport>>(std::move(message->content));
      next_ = 0;
    }
  }
  void seek(std::uint64_t time_ns) {
    from_ = LocalTime(Duration(static_cast<std::int64_t>(time_ns)));
    file_.seek(beforeRepeat(time_ns));  // a message has the time of its first tick
    ticks_.clear();
    next_ = 0;
  }

 private:
  RecordingReader file_;
  LocalTime from_ = LocalTime::min();
  std::vector<client::TickReport> ticks_;  // of the last message
  std::size_t next_ = 0;
};

}  // namespace

class Recording::Impl {
 public:
  explicit Impl(const std::string& file) : file_(file), frames_(openRecording(file)) {
    if (frames_.file().isOfClient()) ticks_.emplace(openRecording(file));
  }

  [[nodiscard]] FrameCursor& frames() { return frames_; }
  [[nodiscard]] std::optional<TickCursor>& ticks() { return ticks_; }
  [[nodiscard]] const std::string& problem() const {
    return ticks_ && frames_.problem().empty() ? ticks_->problem() : frames_.problem();
  }
  [[nodiscard]] RecordingCounts count() const;

 private:
  std::string file_;
  FrameCursor frames_;
  std::optional<TickCursor> ticks_;  // of a client
};

RecordingCounts Recording::Impl::count() const {
  RecordingCounts counts;
  RecordingReader file = openRecording(file_);
  while (const auto message =
             file.next(client::kFrameMessages | client::kTickMessages | client::kPictureMessages)) {
    if (const auto* const ticks = std::get_if<std::vector<client::TickReport>>(&message->content))
      counts.ticks += ticks->size();
    else if (std::holds_alternative<VideoFrame>(message->content))
      ++counts.pictures;
    else
      ++counts.frames;
  }
  counts.problem = file.problem();
  return counts;
}

const std::vector<std::string>& listLookups() {
  static const std::vector<std::string> names(client::kLookupNames.begin(),
                                              client::kLookupNames.end());
  return names;
}

const std::vector<std::string>& listFaults() {
  static const std::vector<std::string> names(client::kFaultNames.begin(),
                                              client::kFaultNames.end());
  return names;
}

Recording::Recording(const std::string& file) : impl_(std::make_unique<Impl>(file)) {}
Recording::~Recording() = default;
Recording::Recording(Recording&& from) noexcept = default;
Recording& Recording::operator=(Recording&& from) noexcept = default;

Recording::Kind Recording::kind() const { return impl_->ticks() ? Kind::kClient : Kind::kServer; }

std::int64_t Recording::start_ns() const { return toSigned(impl_->frames().file().begin_ns()); }

std::int64_t Recording::end_ns() const { return toSigned(impl_->frames().file().end_ns()); }

const std::optional<StreamInfo>& Recording::info() const { return impl_->frames().info(); }

RecordingCounts Recording::count() const { return impl_->count(); }

std::optional<Frame> Recording::nextFrame() { return impl_->frames().next(); }

std::optional<RecordedTick> Recording::nextTick() {
  return impl_->ticks() ? impl_->ticks()->next() : std::nullopt;
}

void Recording::seek(std::int64_t time_ns) {
  const auto from_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  impl_->frames().seek(from_ns);
  if (impl_->ticks()) impl_->ticks()->seek(from_ns);
}

const std::string& Recording::problem() const { return impl_->problem(); }

}  // namespace hapticast
