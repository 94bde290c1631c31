// SPDX-License-Identifier: MIT
#include "client/haptics/playback/scene_interpolator.hpp"

#include <algorithm>

#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {

constexpr double kLongestExtrapolation_s = 0.080;
constexpr double kLongestHold_s = 0.300;
// Share of an interval: latest begin of the blend towards a late frame. A later begin would make
// the change of shape a blow.
constexpr double kLatestBlend = 0.75;
// Frames farther apart than both limits are not one motion. Otherwise a frame of the far future
// would extend the life of an old frame.
constexpr double kWidestGap_s = 1.0;
constexpr double kWidestGap_intervals = 3.0;
// Frames held before the current one: for the cubic and the plausibility bounds.
constexpr std::size_t kKept = 2;
// Slots that always remain for the decode thread.
constexpr std::size_t kSpareSlots = 4;

bool earlier(const PlayFrame& a, const PlayFrame& b) noexcept {
  return a.epoch != b.epoch ? a.epoch < b.epoch : a.media_time < b.media_time;
}

std::size_t objectCount(const PlayFrame& frame) noexcept {
  return std::min(frame.object_count, kMaxObjects);
}

void setPose(InterpolatedObject& object, const Pose& pose) noexcept {
  object.position_mm = pose.position_mm;
  object.velocity_mm_s = pose.velocity_mm_s;
  object.acceleration_mm_s2 = pose.acceleration_mm_s2;
  object.angle_rad = pose.angle_rad;
  object.angular_velocity_rad_s = pose.angular_velocity_rad_s;
}

struct Blend {
  double value;
  double rate_1_s;
};

/// `rate_1_s` is 1 / interval. The blend towards a late frame begins at its arrival, `alone_s`.
Blend computeBlend(double time_s, double interval_s, double rate_1_s, double alone_s) noexcept {
  const double from_s = std::min(alone_s, kLatestBlend * interval_s);
  if (from_s > 0.0) rate_1_s = 1.0 / (interval_s - from_s);
  return {std::clamp((time_s - from_s) * rate_1_s, 0.0, 1.0), rate_1_s};
}

void stop(InterpolatedObject& object) noexcept {
  object.velocity_mm_s.setZero();
  object.acceleration_mm_s2.setZero();
  object.angular_velocity_rad_s = 0.0;
  object.blend_rate_1_s = 0.0;
}

double extrapolationLimit_s(const StreamTiming& stream) noexcept {
  return std::clamp(2.0 * toSeconds(stream.frame_interval), 0.0, kLongestExtrapolation_s);
}

Lookup classifyWithoutNext(double time_s, double limit_s) noexcept {
  if (time_s <= limit_s) return Lookup::kExtrapolated;
  return time_s <= kLongestHold_s ? Lookup::kHeld : Lookup::kStale;
}

}  // namespace

SceneInterpolator::SceneInterpolator(FramePool& pool, Interpolation interpolation) noexcept
    : pool_(pool), interpolation_(interpolation) {}

const Scene& SceneInterpolator::at(MediaTime play_time, const StreamTiming& stream,
                                   const UserControls& user) noexcept {
  popArrived(play_time, stream.first_epoch);
  const std::size_t before = releaseUnneeded(play_time);
  scene_.play_time = play_time;
  scene_.jumped = false;
  scene_.object_count = 0;
  scene_.kind = Lookup::kEmpty;
  if (before != kNone) fillScene(before, play_time, stream, user);
  return scene_;
}

void SceneInterpolator::resync() noexcept {
  while (held_count_ > 0) release(held_count_ - 1);
  FramePool::Index index = 0;
  for (std::size_t i = 0; i < FramePool::kSlots && pool_.pop(index); ++i) pool_.release(index);
  played_ = false;
}

std::array<const PlayFrame*, 4> SceneInterpolator::neighbours(MediaTime play_time) const noexcept {
  std::array<const PlayFrame*, 4> around{};
  const std::size_t before = beforeIndex(play_time);
  if (before == kNone) return around;
  for (std::size_t k = 0; k < around.size(); ++k) {
    const std::size_t i = before + k;  // k = 0 is the frame before - 1, so i counts one too high
    if (i == 0 || i > held_count_) continue;
    if (frame(i - 1).epoch == frame(before).epoch) around[k] = &frame(i - 1);
  }
  return around;
}

std::size_t SceneInterpolator::beforeIndex(MediaTime play_time) const noexcept {
  for (std::size_t i = held_count_; i-- > 0;) {
    if (frame(i).media_time <= play_time) return i;
  }
  return kNone;
}

void SceneInterpolator::popArrived(MediaTime play_time, std::uint32_t first_epoch) noexcept {
  while (held_count_ > 0 && frame(0).epoch < first_epoch) release(0);
  FramePool::Index index = 0;
  for (std::size_t i = 0; i < FramePool::kSlots && pool_.pop(index); ++i) {
    if (pool_.frame(index).epoch < first_epoch) {
      pool_.release(index);
    } else {
      insert(index, play_time);
    }
  }
}

void SceneInterpolator::insert(FramePool::Index index, MediaTime play_time) noexcept {
  const PlayFrame& arrived = pool_.frame(index);
  std::size_t position = held_count_;
  for (std::size_t i = 0; i < held_count_; ++i) {
    const PlayFrame& held = frame(i);
    if (held.epoch == arrived.epoch &&
        (held.media_time == arrived.media_time || held.id == arrived.id)) {
      pool_.release(index);
      return;
    }
    if (position == held_count_ && earlier(arrived, held)) position = i;
  }
  if (played_ && arrived.epoch == scene_.epoch && arrived.media_time < play_time) ++late_frames_;
  for (std::size_t i = held_count_; i > position; --i) held_[i] = held_[i - 1];
  held_[position] = index;
  ++held_count_;
  pair_.now = nullptr;
}

void SceneInterpolator::release(std::size_t i) noexcept {
  pool_.release(held_[i]);
  --held_count_;
  pair_.now = nullptr;
  for (; i < held_count_; ++i) held_[i] = held_[i + 1];
}

std::size_t SceneInterpolator::releaseUnneeded(MediaTime play_time) noexcept {
  std::size_t before = beforeIndex(play_time);
  for (; before != kNone && before > kKept; --before) release(0);
  // More frames ahead than slots: thin them out. The next two frames and the newest remain, for the
  // cubic. The others remain evenly spread over time.
  const std::size_t first = before == kNone ? 2 : before + 3;
  while (held_count_ > FramePool::kSlots - kSpareSlots) {
    std::size_t densest = first;
    double smallest_s = secondsBetween(frame(first - 1).media_time, frame(first + 1).media_time);
    for (std::size_t i = first + 1; i + 1 < held_count_; ++i) {
      const double gap_s = secondsBetween(frame(i - 1).media_time, frame(i + 1).media_time);
      if (gap_s < smallest_s) {
        smallest_s = gap_s;
        densest = i;
      }
    }
    release(densest);
  }
  return before;
}

const PlayFrame* SceneInterpolator::findNext(std::size_t before,
                                             const StreamTiming& stream) const noexcept {
  if (before + 1 >= held_count_) return nullptr;
  const PlayFrame& now = frame(before);
  const PlayFrame& next = frame(before + 1);
  const double widest_s =
      std::max(kWidestGap_s, kWidestGap_intervals * toSeconds(stream.frame_interval));
  const bool connected =
      next.epoch == now.epoch && secondsBetween(now.media_time, next.media_time) <= widest_s;
  return connected ? &next : nullptr;
}

void SceneInterpolator::cacheInterval(std::size_t before, const PlayFrame* next,
                                      double interval_s) noexcept {
  const PlayFrame& now = frame(before);
  if (pair_.now == &now && pair_.next == next && pair_.interval_s == interval_s) return;
  pair_.now = &now;
  pair_.next = next;
  pair_.interval_s = interval_s;
  pair_.rate_1_s = next != nullptr ? 1.0 / interval_s : 0.0;
  for (std::size_t i = 0; i < objectCount(now); ++i) {
    const PlayObject& object = now.objects[i];
    pair_.after[i] = findObject(next, makeKey(object));
    if (pair_.after[i] == nullptr) continue;
    pair_.path[i] = HermitePath(object, *pair_.after[i], now.media_time, interval_s);
  }
  computeBounds(before, next);
}

void SceneInterpolator::computeBounds(std::size_t before, const PlayFrame* next) noexcept {
  const std::uint32_t epoch = frame(before).epoch;
  const auto ofEpoch = [&](std::size_t i) noexcept {
    return i < held_count_ && frame(i).epoch == epoch ? &frame(i) : nullptr;
  };
  const std::array<const PlayFrame*, ObjectHistory::kFrames> frames = {
      before > 1 ? ofEpoch(before - 2) : nullptr, before > 0 ? ofEpoch(before - 1) : nullptr,
      &frame(before), next, next != nullptr ? ofEpoch(before + 2) : nullptr};
  ObjectHistory seen;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    if (frames[k] == nullptr || frames[k + 1] == nullptr) continue;
    seen.interval_s[k] = secondsBetween(frames[k]->media_time, frames[k + 1]->media_time);
  }
  for (std::size_t i = 0; i < objectCount(frame(before)); ++i) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      seen.object[k] = findObject(frames[k], makeKey(frame(before).objects[i]));
    }
    pair_.plausibility[i] = computePlausibilityBounds(seen);
  }
}

void SceneInterpolator::fillScene(std::size_t before, MediaTime play_time,
                                  const StreamTiming& stream, const UserControls& user) noexcept {
  const PlayFrame& now = frame(before);
  const PlayFrame* const next = findNext(before, stream);
  const bool has_next = next != nullptr;
  const double time_s = secondsBetween(now.media_time, play_time);
  // Times beyond 2^53 ns are rounded: the interval must not become zero.
  const double interval_s =
      has_next ? std::max({secondsBetween(now.media_time, next->media_time), time_s, 1e-9}) : 0.0;
  const double limit_s = extrapolationLimit_s(stream);
  if (now.epoch != scene_.epoch || now.id != alone_id_) alone_s_ = 0.0;
  alone_id_ = now.id;
  if (!has_next) alone_s_ = std::max(time_s, 0.0);

  scene_.kind = has_next ? Lookup::kInterpolated : classifyWithoutNext(time_s, limit_s);
  scene_.jumped = !played_ || now.epoch != scene_.epoch;
  scene_.epoch = now.epoch;
  scene_.object_count = objectCount(now);
  played_ = true;
  cacheInterval(before, next, interval_s);
  const Blend blend = computeBlend(time_s, interval_s, pair_.rate_1_s, alone_s_);
  const Moment moment{now.media_time, time_s, interval_s, limit_s, blend.value, blend.rate_1_s};
  for (std::size_t i = 0; i < scene_.object_count; ++i) {
    placeObject(i, now.objects[i], moment);
    if (user.paused) stop(scene_.objects[i]);
    scene_.objects[i].appeared = scene_.jumped || !wasThere(now.objects[i]);
  }
  frame_count_ = scene_.object_count;
  for (std::size_t i = 0; i < frame_count_; ++i) frames_[i] = makeKey(now.objects[i]);
}

void SceneInterpolator::placeObject(std::size_t i, const PlayObject& object,
                                    const Moment& moment) noexcept {
  InterpolatedObject& out = scene_.objects[i];
  out.before = &object;
  out.after = nullptr;
  out.blend = out.blend_rate_1_s = 0.0;
  out.plausibility = pair_.plausibility[i];
  const PlayObject* const after = pair_.after[i];
  if (interpolation_ == Interpolation::kHold) {
    setPose(out, restingPose(object.motion));
  } else if (after == nullptr) {
    setPose(out, deadReckonedPose(object, moment.begin, moment.limit_s, moment.time_s));
  } else {
    out.after = after;
    out.blend = moment.blend;
    out.blend_rate_1_s = moment.blend_rate_1_s;
    setPose(out, interpolation_ == Interpolation::kLinear
                     ? linearPose(object.motion, after->motion, moment.interval_s, moment.time_s)
                     : pair_.path[i].at(moment.time_s));
  }
}

bool SceneInterpolator::wasThere(const PlayObject& object) const noexcept {
  const std::uint64_t* const last = frames_.data() + frame_count_;
  return std::find(frames_.data(), last, makeKey(object)) != last;
}

}  // namespace hapticast::client
