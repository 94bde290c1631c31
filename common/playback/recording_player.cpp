// SPDX-License-Identifier: MIT
#include "common/playback/recording_player.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

/// Multiplies `vector` by `factor`. No component exceeds `limit`, which viewers accept.
template <class Vector>
void scale(Vector& vector, double factor, double limit) {
  using Scalar = typename Vector::Scalar;
  const auto most = static_cast<Scalar>(limit);
  vector = (vector * static_cast<Scalar>(factor)).cwiseMax(-most).cwiseMin(most).eval();
}

/// Converts the motion of `object` to that at `speed`.
void changeSpeed(CodedObject& object, double speed) {
  const double square = speed * speed;
  Motion& motion = object.motion;
  scale(motion.velocity_mm_s, speed, limits::kVelocity_mm_s);
  scale(motion.acceleration_mm_s2, square, limits::kAcceleration_mm_s2);
  motion.angular_velocity_rad_s =
      std::clamp(motion.angular_velocity_rad_s * speed, -limits::kAngularVelocity_rad_s,
                 limits::kAngularVelocity_rad_s);
  for (Impact& impact : object.impacts)
    scale(impact.delta_velocity_mm_s, speed, limits::kVelocity_mm_s);
  if (!object.grid) return;
  auto grid = std::make_shared<MotionGrid>(*object.grid);
  for (auto& cell : grid->velocity_mm_s) scale(cell, speed, limits::kVelocity_mm_s);
  for (auto& cell : grid->acceleration_mm_s2) scale(cell, square, limits::kAcceleration_mm_s2);
  object.grid = std::move(grid);
}

}  // namespace

StreamDescription describePlayback(const StreamDescription& recorded, double speed,
                                   const std::string& name) {
  StreamDescription description = recorded;
  if (!name.empty()) description.name = name;
  description.fps = std::clamp(recorded.fps * speed, limits::kMinFps, limits::kMaxFps);
  // Viewers derive a bound of the force from it, so it never falls.
  const double factor = std::max(1.0, speed * speed);
  description.largest_acceleration_mm_s2 =
      std::min(recorded.largest_acceleration_mm_s2 * factor, limits::kAcceleration_mm_s2);
  description.timeline.reset();
  return description;
}

RecordingPlayer::RecordingPlayer(StreamReader reader, bool loop)
    : reader_(std::move(reader)), loop_(loop) {}

std::optional<MediaTime> RecordingPlayer::prepare(MediaTime now) {
  while (!item_) {
    item_ = read();
    if (!item_) return std::nullopt;
    // A picture belongs to the frame before it.
    const auto* const picture = std::get_if<VideoFrame>(&*item_);
    if (picture != nullptr && (!last_ || picture->media_time != last_->recorded)) item_.reset();
  }
  // A description belongs to the next frame, a picture to the last one.
  const auto* const frame = std::get_if<CodedFrame>(&*item_);
  if (frame == nullptr) return now;
  if (!is_planned_) plan(*frame, now);
  return due_;
}

std::optional<RecordedItem> RecordingPlayer::read() {
  if (auto item = reader_.next()) return item;
  if (problem_.empty() && !reader_.problem().empty()) {
    problem_ = reader_.problem();
    played_ = last_ ? last_->recorded - reader_.begin() : Duration(0);
  }
  if (!loop_) return std::nullopt;
  reader_.seek(reader_.begin());
  is_continuous_ = false;
  return reader_.next();
}

void RecordingPlayer::plan(const CodedFrame& frame, MediaTime now) {
  const bool follows = last_ && is_continuous_ && frame.media_time > last_->recorded &&
                       frame.media_time - last_->recorded <= kLongestGap &&
                       now - toPlayed(frame.media_time) <= kLatest;
  if (!last_ && std::chrono::abs(now - frame.media_time) <= kLatest) {  // the first pass
    origin_ = start_ = frame.media_time;
  } else if (!follows) {
    origin_ = frame.media_time;
    const Duration interval = fromSeconds(1.0 / reader_.description().fps);
    start_ = last_ ? std::max(now, last_->time + interval) : now;
    recorded_first_id_ = frame.id;
    first_id_ = last_ ? last_->id + 1 : frame.id;
    epoch_shift_ = last_ ? last_->epoch + 1 - frame.epoch : 0;
  }
  is_continuous_ = is_planned_ = true;
  due_ = toPlayed(frame.media_time);
}

RecordedItem RecordingPlayer::take() {
  RecordedItem item = std::move(*std::exchange(item_, std::nullopt));
  is_planned_ = false;
  if (auto* const frame = std::get_if<CodedFrame>(&item)) {
    const MediaTime recorded = frame->media_time;
    change(*frame);
    last_ = Last{recorded, frame->media_time, frame->id, frame->epoch};
  } else if (auto* const picture = std::get_if<VideoFrame>(&item)) {
    picture->media_time = last_->time;
    picture->id = last_->id;
    picture->epoch = last_->epoch;
  }
  return item;
}

void RecordingPlayer::change(CodedFrame& frame) const {
  const auto toId = [this](std::uint64_t recorded) {
    // A relief from before the discontinuity is new, since other frames may have had its number.
    return recorded < recorded_first_id_ ? first_id_ : recorded - recorded_first_id_ + first_id_;
  };
  const MediaTime recorded = frame.media_time;
  frame.media_time = toPlayed(recorded);
  frame.id = toId(frame.id);
  frame.epoch += epoch_shift_;
  for (CodedObject& object : frame.objects) {
    object.changed_in_frame = std::min(toId(object.changed_in_frame), frame.id);
    for (Impact& impact : object.impacts)
      impact.time =
          toPlayed(std::clamp(impact.time, recorded - kLongestGap, recorded + kLongestGap));
    if (speed_ != 1.0) changeSpeed(object, speed_);
  }
}

MediaTime RecordingPlayer::toPlayed(MediaTime recorded) const {
  const Duration since = recorded - origin_;
  if (speed_ == 1.0) return start_ + since;
  return start_ + Duration(std::llround(static_cast<double>(since.count()) / speed_));
}

Timeline RecordingPlayer::timeline() const {
  const double length_s = std::clamp(toSeconds(reader_.length()), 0.0, limits::kClip_s);
  return {length_s, std::clamp(toSeconds(origin_ - reader_.begin()), 0.0, length_s), start_,
          speed_};
}

void RecordingPlayer::seek(double time_s) {
  const double most_s = toSeconds(reader_.length());
  reader_.seek(reader_.begin() + fromSeconds(std::clamp(time_s, 0.0, most_s)));
  item_.reset();
  resume();
}

void RecordingPlayer::setSpeed(double speed) {
  speed_ = std::clamp(speed, limits::kLeastSpeed, limits::kMostSpeed);
  resume();
}

}  // namespace hapticast
