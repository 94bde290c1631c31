// SPDX-License-Identifier: MIT
#include "server/source/child/child_source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Chosen: frames in flight. A child that answers after a few more pictures works, too.
constexpr std::size_t kMostRecorded = 8;
constexpr std::size_t kMostLive = 4;
constexpr Duration kLivePause = milliseconds(500);  // chosen: above the time of a frame
constexpr Duration kSlice = milliseconds(50);
constexpr Duration kShortWait = milliseconds(10);  // while a live source may have a frame
// Chosen: networks load for a minute, and are slow on a processor.
constexpr Duration kFirstPatience = seconds(180);
constexpr Duration kPatience = seconds(20);
constexpr Duration kLivePatience = seconds(4);     // as kLongestSilence of a live stream
constexpr Duration kLateMask = milliseconds(200);  // chosen: the delay of a live source by masks
constexpr Duration kGapLine = seconds(1);          // chosen: as kGap of a live source
constexpr Duration kSendAgain = seconds(1);
constexpr Duration kRestartPause = seconds(1);
constexpr int kMostFailures = 3;
constexpr int kManyLate = 10;  // chosen: in a row

}  // namespace

ChildSource::ChildSource(std::unique_ptr<RgbdSource> source, std::unique_ptr<ChildTask> task,
                         KeepWaiting keep_waiting)
    : source_(std::move(source)),
      task_(std::move(task)),
      keep_waiting_(std::move(keep_waiting)),
      info_(source_->info()),
      skipped_(info_.live) {
  spdlog::info("{} runs: {}", task_->flag(), task_->command());
  waitForFirst();
  if (phase_ == Phase::kOpening) phase_ = Phase::kServing;
  task_->describe(info_);
}

void ChildSource::waitForFirst() {
  while ((pending_.empty() || !pending_.front()->ready) && keepsWaiting()) {
    if (ended_ && pending_.empty()) throw SourceError(info_.name + ": has no frame");
    while (hasRoom() && askNext()) {
    }
    if (ended_) sendLastAgain();
    receive(kSlice);
    logGap();
  }
  if (pending_.empty() || !pending_.front()->ready)
    throw SourceError(name() + ": was ended before its first answer");
  const Pending& first = *pending_.front();
  if (!first.problem.empty()) throw SourceError(name() + ": " + first.problem + "; mend it");
}

bool ChildSource::hasRoom() {
  if (!info_.live) return pending_.size() < kMostRecorded;
  // A child that needs more pictures for its first answer receives them.
  const bool waits = asked_.size() >= most_live_ && clock_.now() - last_sign_ > kLivePause;
  if (waits && most_live_ < kMostLive) ++most_live_;
  return asked_.size() < most_live_ && pending_.size() < kMostLive;
}

std::string ChildSource::name() const {
  return std::string(task_->flag()) + " " + quote(task_->command());
}

std::optional<RgbdFrame> ChildSource::read() { return info_.live ? readLive() : readRecorded(); }

std::optional<RgbdFrame> ChildSource::readRecorded() {
  for (;;) {
    while (hasRoom() && askNext()) {
    }
    receive(Duration{});
    if (auto frame = popReady()) {
      ++frames_read_;
      return frame;
    }
    if (pending_.empty() && ended_) break;
    if (pending_.empty()) continue;
    if (!keepsWaiting()) return std::nullopt;
    if (ended_) sendLastAgain();
    logGap();
    receive(kSlice);
  }
  if (frames_read_ == 0 && !skipped_.problem().empty())
    throw SourceError(skipped_.cancelRun() + ", and no frame after it can be used either; mend it");
  skipped_.endRun();
  return std::nullopt;
}

std::optional<RgbdFrame> ChildSource::readLive() {
  receive(asked_.empty() ? Duration{} : kShortWait);
  if (pending_.empty() || (!pending_.front()->ready && hasRoom())) {
    (void)askNext();
  } else if (!pending_.front()->ready) {
    receive(kSlice);
  }
  passLate();
  logGap();
  return popReady();
}

std::optional<RgbdFrame> ChildSource::popReady() {
  while (!pending_.empty() && pending_.front()->ready) {
    Pending oldest = std::move(*pending_.front());
    pending_.pop_front();
    const Duration age = oldest.frame.age + (clock_.now() - oldest.since);
    const bool is_late = info_.live && task_->isRequired() && age > kGapLine;
    if (is_late && oldest.loads) continue;  // it waited while the child was loading
    if (is_late)
      oldest.problem = "answers after more than 1 s; a live source needs a faster program";
    if (!oldest.problem.empty() && !task_->isRequired()) {
      if (!std::exchange(logged_.problem, true))
        spdlog::warn("{}: {}; frame {} has no mask of it", name(), oldest.problem,
                     oldest.frame.index);
      oldest.problem.clear();
    }
    if (!oldest.problem.empty()) {
      skipped_.add(oldest.frame.index, name() + ": " + oldest.problem);
      continue;
    }
    skipped_.endRun();
    if (info_.live) {
      oldest.frame.age = age;
      if (oldest.frame.epoch != source_epoch_) epoch_begin_s_ = 0.0;  // the source had a gap, too
      source_epoch_ = oldest.frame.epoch;
      oldest.frame.epoch += gaps_;
      oldest.frame.clip_time_s = std::max(0.0, oldest.frame.clip_time_s - epoch_begin_s_);
    }
    return std::move(oldest.frame);
  }
  return std::nullopt;
}

bool ChildSource::askNext() {
  if (ended_) return false;
  std::optional<RgbdFrame> frame = source_->read();
  if (!frame) {
    ended_ = !info_.live;
    return false;
  }
  // The clip may have begun again since the child received this picture.
  const auto asked = std::find_if(asked_.begin(), asked_.end(), [&](const Waiting& each) {
    return each != nullptr && each->frame.index == frame->index && !info_.live;
  });
  if (asked != asked_.end()) {
    (*asked)->frame = std::move(*frame);
    pending_.push_back(*asked);
    return true;
  }
  auto waiting =
      std::make_shared<Pending>(Pending{.frame = std::move(*frame), .since = clock_.now()});
  pending_.push_back(waiting);
  waiting->ready = task_->recall(waiting->frame);
  // Without a child receive() starts one, and sends what waits in its order.
  if (!waiting->ready && pipe_ != nullptr) send(waiting);
  if (pipe_ == nullptr && !task_->isRequired() && phase_ != Phase::kOpening) waiting->ready = true;
  return true;
}

void ChildSource::startChild() {
  const LocalTime now = clock_.now();
  if (phase_ == Phase::kGivenUp || now < restart_at_) return;
  const bool waits = std::any_of(pending_.begin(), pending_.end(),
                                 [](const Waiting& each) { return !each->ready; });
  if (!waits && !wants_child_) return;
  try {
    pipe_ = std::make_unique<ChildPipe>(
        task_->command(), [this](const std::string& header) { return task_->measure(header); });
  } catch (const SourceError& error) {
    return restart(error.what());
  }
  wants_child_ = false;
  answers_ = 0;
  last_sign_ = now;
  for (const Waiting& waiting : pending_) {
    if (!waiting->ready) send(waiting);
  }
}

void ChildSource::send(const Waiting& waiting) {
  if (asked_.empty()) last_sign_ = clock_.now();
  waiting->loads = info_.live && answers_ == 0;
  last_request_ = task_->ask(waiting->frame);
  pipe_->push(last_request_);
  asked_.push_back(waiting);
}

void ChildSource::sendLastAgain() {
  if (pipe_ == nullptr || asked_.size() > kMostRecorded) return;
  const bool due = clock_.now() - last_sign_ >= kSendAgain;
  if (sent_again_ >= lag_ && !due) return;
  lag_ = std::max(lag_, ++sent_again_);
  last_sign_ = clock_.now();
  pipe_->push(last_request_);
  asked_.push_back(nullptr);
}

void ChildSource::receive(Duration longest) {
  if (pipe_ == nullptr) startChild();
  if (pipe_ == nullptr) {
    if (longest > Duration{}) std::this_thread::sleep_for(longest);
    return;
  }
  while (auto answer = pipe_->pop(longest)) {
    addAnswer(*answer);
    longest = Duration{};
  }
  const std::string problem = pipe_->problem();
  const Duration patience = info_.live ? kLivePatience : kPatience;
  const bool hangs =
      !asked_.empty() && clock_.now() - last_sign_ > (answers_ > 0 ? patience : kFirstPatience);
  if (!problem.empty()) return restart(problem);
  if (hangs) restart("gives no answer");
}

void ChildSource::addAnswer(const ChildAnswer& answer) {
  const Waiting waiting = asked_.front();
  asked_.pop_front();
  const LocalTime now = clock_.now();
  if (++answers_ == 1) most_live_ = 2;  // it has grown while the child was loading
  usual_ = (usual_ + (now - last_sign_)) / 2;
  if (gap_.is_logged && info_.live && task_->isRequired() && waiting != nullptr &&
      std::exchange(gap_.begins_epoch, false)) {
    ++gaps_;
    epoch_begin_s_ = waiting->frame.clip_time_s;
  }
  last_sign_ = now;
  // A child that dies after each few answers stays in the gap.
  if (failures_ == 0 || answers_ > kMostRecorded) {
    failures_ = 0;
    if (std::exchange(gap_.is_logged, false))
      spdlog::info("{}: answers are back after {:.1f} s", name(), toSeconds(now - gap_.begin));
  }
  if (waiting == nullptr || waiting->ready) return;
  late_ = 0;
  waiting->problem = task_->apply(waiting->frame, answer);
  waiting->ready = true;
}

void ChildSource::restart(const std::string& problem) {
  const bool first = phase_ == Phase::kOpening && answers_ == 0;  // the command never worked
  ++failures_;
  pipe_.reset();
  asked_.clear();
  sent_again_ = 0;
  gap_.begins_epoch = true;
  wants_child_ = !task_->isRequired();
  restart_at_ = clock_.now() + kRestartPause;
  const bool gives_up = !info_.live && failures_ >= kMostFailures;
  if (first || (gives_up && task_->isRequired()))
    throw SourceError(name() + ": " + problem + "; mend the command");
  if (gives_up) {
    phase_ = Phase::kGivenUp;
    spdlog::warn("{}: {} three times; the server goes on without it", name(), problem);
  } else {
    beginGap(problem + "; the server starts it again each second");
  }
  if (info_.live && task_->isRequired()) pending_.clear();
  for (const Waiting& waiting : pending_) waiting->ready = waiting->ready || !task_->isRequired();
}

void ChildSource::passLate() {
  const LocalTime now = clock_.now();
  for (const Waiting& waiting : pending_) {
    if (task_->isRequired() || waiting->ready || now - waiting->since <= kLateMask) continue;
    waiting->ready = true;
    if (++late_ == kManyLate)
      spdlog::warn("{}: its answers come later than {:.1f} s, so the frames do without", name(),
                   toSeconds(kLateMask));
  }
}

void ChildSource::logGap() {
  const Duration longest = std::max<Duration>(kGapLine, 3 * usual_);
  if (asked_.empty() || gap_.is_logged || clock_.now() - last_sign_ <= longest) return;
  if (answers_ == 0) {
    if (!std::exchange(logged_.wait, true))
      spdlog::info("waiting for the first answer of {}", name());
    return;
  }
  beginGap(fmt::format("no answer for {:.0f} s; the server waits", toSeconds(longest)));
}

void ChildSource::beginGap(const std::string& line) {
  if (gap_.is_logged) return;
  gap_ = {.is_logged = true, .begins_epoch = true, .begin = last_sign_};
  spdlog::warn("{}: {}", name(), line);
}

bool ChildSource::skip() {
  if (pending_.empty()) return !ended_ && source_->skip();
  pending_.pop_front();
  return true;
}

void ChildSource::rewind() {
  if (ended_ && !std::exchange(logged_.advice, true) && *task_->advise() != '\0')
    spdlog::info("{}: {}", name(), task_->advise());
  source_->rewind();
  pending_.clear();
  ended_ = false;
  frames_read_ = 0;
  sent_again_ = 0;
}

}  // namespace hapticast::server
