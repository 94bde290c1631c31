// SPDX-License-Identifier: MIT
#include "server/vision/offline/relief_fusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "server/vision/base/statistics.hpp"
#include "server/vision/track.hpp"

namespace hapticast::server {

namespace {

constexpr std::array<int, 5> kWindows{1, 2, 4, 8, 16};  // frames on each side
// Widths of the boxes whose means are compared. Chosen: small parts, and slight smooth errors.
constexpr std::array kTests_px{9, 33};
constexpr int kNoise_px = 33;  // chosen: width of the box over which the noise is measured
// Widest interval, and least share of the places around that have to agree. Measured by the topic
// bake of the evaluation: at 2 and 0.5 one scene is worse than live.
constexpr double kSigmas = 3.5;
constexpr double kMajority = 0.75;
constexpr double kRounding_mm = 1e-4;      // of heights as floats
constexpr double kMedianOfSquare = 0.455;  // median of the square of a standard normal value
constexpr double kMostNoise = 2.0;         // chosen: local noise over that of the whole object
// Frames in the average of the static-region filter (Tile::kFrames): fewer are no gain at rest.
constexpr float kHeldFrames = 16.0F;
constexpr std::int64_t kLargePicture_px = 1'000'000;  // chosen: bounds the memory to some 500 MB
constexpr float kSame_mm = 0.004F;  // chosen: a fifth of the error of heights on the wire

/// Heights over a relief's rectangle, and where they count (CV_32FC1, 0 or 1).
struct Heights {
  cv::Mat height_mm;
  cv::Mat valid;
};

cv::Mat viewHeights(const Relief& relief) {
  return {relief.rect.height, relief.rect.width, CV_32FC1,
          const_cast<float*>(relief.height_mm.data())};
}

// Heights at the ends of the range are cut off, so they have no part in means.
Heights readHeights(const Relief& relief, double top_mm) {
  const cv::Mat mask(relief.rect.height, relief.rect.width, CV_8UC1,
                     const_cast<std::uint8_t*>(relief.mask.data()));
  const cv::Mat height = viewHeights(relief);
  Heights out{height, {}};
  const cv::Mat inside = (mask != 0) & (height > 0.0F) & (height < top_mm);
  inside.convertTo(out.valid, CV_32F, 1.0 / 255.0);
  return out;
}

/// A relief's rectangle and the object's motion in one frame.
struct Placement {
  const PixelRect& rect;
  const Motion& motion;

  [[nodiscard]] bool restsAt(const Placement& other) const {
    return motion.position_mm == other.motion.position_mm &&
           motion.angle_rad == other.motion.angle_rad;
  }
};

/// Returns a point of the picture with this height in the camera's frame, mm.
Vec3 liftPoint(const Vec2& px, double height_mm, const FusionView& view) {
  const double gain = (view.range.far_mm - view.range.near_mm) / view.workspace.depth_mm;
  return (view.range.far_mm - gain * height_mm) * view.camera.ray(px.x(), px.y());
}

/// Returns the reference point in the camera's frame, mm.
Vec3 liftReference(const Motion& motion, const FusionView& view) {
  return liftPoint(view.workspace.toImage(motion.position_mm.head<2>()), motion.position_mm.z(),
                   view);
}

/// Returns for each pixel of `now`, whose heights are `height_mm`, its place in the relief of
/// `then` (CV_32FC2, px): the body moves and turns about the line of sight.
cv::Mat findPlaces(const Placement& now, const cv::Mat& height_mm, const Placement& then,
                   const FusionView& view) {
  const double turn_rad = then.motion.angle_rad - now.motion.angle_rad;
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  const Vec3 from = liftReference(now.motion, view);
  const Vec3 to = liftReference(then.motion, view);
  cv::Mat out(height_mm.size(), CV_32FC2);
  for (int v = 0; v < out.rows; ++v) {
    const auto* height = height_mm.ptr<float>(v);
    auto* place = out.ptr<cv::Vec2f>(v);
    for (int u = 0; u < out.cols; ++u) {
      const Vec2 px(u + now.rect.u + 0.5, v + now.rect.v + 0.5);
      const Vec3 r = liftPoint(px, height[u], view) - from;
      // The angle turns from x to y, and the camera's Y points down.
      const Vec3 at = to + Vec3(c * r.x() + s * r.y(), c * r.y() - s * r.x(), r.z());
      const Vec2 seen = view.camera.project(at) - Vec2(then.rect.u + 0.5, then.rect.v + 0.5);
      place[u] = {static_cast<float>(seen.x()), static_cast<float>(seen.y())};
    }
  }
  return out;
}

// Returns the heights of another frame, carried to the rectangle of this one.
Heights carryHeights(const Heights& own, const Placement& now, const Heights& other,
                     const Placement& then, const FusionView& view) {
  Heights out;
  if (now.restsAt(then)) {
    const cv::Matx23d shift(1, 0, now.rect.u - then.rect.u, 0, 1, now.rect.v - then.rect.v);
    const int flags = cv::WARP_INVERSE_MAP | cv::INTER_NEAREST;
    cv::warpAffine(other.height_mm, out.height_mm, shift, own.height_mm.size(), flags);
    cv::warpAffine(other.valid, out.valid, shift, own.height_mm.size(), flags);
    return out;
  }
  const cv::Mat places = findPlaces(now, own.height_mm, then, view);
  cv::Mat support;  // all pixels that the cubic interpolation reads
  cv::erode(other.valid, support, cv::Mat::ones(3, 3, CV_8UC1), {-1, -1}, 1, cv::BORDER_CONSTANT,
            cv::Scalar(0));
  cv::remap(other.height_mm, out.height_mm, places, {}, cv::INTER_CUBIC);
  cv::remap(support, out.valid, places, {}, cv::INTER_LINEAR);
  cv::threshold(out.valid, out.valid, 0.999, 1.0, cv::THRESH_BINARY);
  out.height_mm += now.motion.position_mm.z() - then.motion.position_mm.z();
  return out;
}

// Returns the mean of `values` over a box, where `valid` is 1.
cv::Mat averageInBox(const cv::Mat& values, const cv::Mat& valid, int width_px) {
  cv::Mat sum;
  cv::Mat count;
  const cv::Size box(width_px, width_px);
  cv::boxFilter(values.mul(valid), sum, CV_32F, box, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::boxFilter(valid, count, CV_32F, box, {-1, -1}, true, cv::BORDER_CONSTANT);
  return sum / cv::max(count, 1e-6);
}

/// Five successive frames.
using Successive = std::array<const Heights*, 5>;

/// Returns the variance of one frame's means over boxes of `test_px`, mm^2; empty: the frames have
/// no common pixels. Fourth differences in time leave out smooth changes of the surface.
cv::Mat measureVariance(const Successive& frames, int test_px) {
  constexpr std::array kDifference{1.0, -4.0, 6.0, -4.0, 1.0};
  constexpr double kSumOfSquares = 70.0;
  cv::Mat valid = frames[0]->valid.clone();
  cv::Mat difference = frames[0]->height_mm.clone();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    valid = valid.mul(frames[i]->valid);
    difference += kDifference[i] * frames[i]->height_mm;
  }
  const cv::Mat mean = averageInBox(difference, valid, test_px);
  const cv::Mat square = mean.mul(mean) / kSumOfSquares;
  std::vector<float> values;
  for (int v = 0; v < square.rows; v += 3) {
    for (int u = 0; u < square.cols; u += 3) {
      if (valid.at<float>(v, u) > 0.0F) values.push_back(square.at<float>(v, u));
    }
  }
  if (values.empty()) return {};
  const double whole = computeMedian(values) / kMedianOfSquare;
  return cv::min(averageInBox(square, valid, kNoise_px), kMostNoise * kMostNoise * whole);
}

/// The window of one object around one frame.
class Window {
 public:
  Window(const Heights& own, const std::map<int, Heights>& others) : own_(own), others_(others) {}

  /// Returns the mean heights; `count` receives the number of frames in each, 1 or more.
  cv::Mat fuse(cv::Mat& count) {
    out_ = own_.height_mm.clone();
    count_ = cv::Mat::ones(out_.size(), CV_32FC1);
    count = count_;
    for (const int box_px : kTests_px) {
      scales_.push_back({box_px, measure(box_px)});
      if (scales_.back().variance.empty()) return out_;
      scales_.back().means.push_back(averageInBox(own_.height_mm, own_.valid, box_px));
    }
    sum_ = own_.height_mm.mul(own_.valid);
    number_ = own_.valid.clone();
    alive_ = own_.valid > 0;
    numbers_.push_back(number_.clone());
    int reached = 0;
    for (const int level : kWindows) {
      for (int k = reached + 1; k <= level; ++k) {
        add(-k);
        add(k);
      }
      reached = level;
      if (cv::countNonZero(alive_) == 0) break;
      acceptLevel();
    }
    count = count_;
    return out_;
  }

 private:
  /// Means of the windows so far over boxes of one size, and their noise.
  struct Scale {
    int box_px;
    cv::Mat variance;                 // of one frame; empty: unknown
    std::vector<cv::Mat> means = {};  // by level
  };

  [[nodiscard]] const Heights* at(int k) const {
    if (k == 0) return &own_;
    const auto found = others_.find(k);
    return found == others_.end() ? nullptr : &found->second;
  }
  /// Returns the least of the variances that the frames around, after and before this one show: a
  /// bounce among them is no noise.
  [[nodiscard]] cv::Mat measure(int box_px) const {
    cv::Mat least;
    for (const int first : {-2, 0, -4}) {
      Successive frames{};
      for (int i = 0; i < 5; ++i) frames[static_cast<std::size_t>(i)] = at(first + i);
      if (std::find(frames.begin(), frames.end(), nullptr) != frames.end()) continue;
      const cv::Mat variance = measureVariance(frames, box_px);
      if (variance.empty()) continue;
      least = least.empty() ? variance : cv::Mat(cv::min(least, variance));
    }
    return least;
  }
  void add(int k) {
    const Heights* const other = at(k);
    if (other == nullptr) return;
    sum_ += other->height_mm.mul(other->valid);
    number_ += other->valid;
  }
  void acceptLevel() {
    const cv::Mat mean = sum_ / cv::max(number_, 1.0);
    numbers_.push_back(number_.clone());
    for (Scale& scale : scales_) {
      scale.means.push_back(averageInBox(mean, own_.valid, scale.box_px));
      for (std::size_t i = 0; i + 1 < scale.means.size(); ++i) {
        const cv::Mat apart = scale.means.back() - scale.means[i];
        const cv::Mat share = 1.0 / cv::max(numbers_[i], 1.0) - 1.0 / cv::max(number_, 1.0);
        const cv::Mat allowed =
            kSigmas * kSigmas * scale.variance.mul(share) + kRounding_mm * kRounding_mm;
        alive_ &= apart.mul(apart) <= allowed;
      }
    }
    // Where most places around disagree, one that agrees does so by chance.
    cv::Mat alive;
    alive_.convertTo(alive, CV_32F, 1.0 / 255.0);
    alive_ &= averageInBox(alive, own_.valid, kTests_px.back()) >= kMajority;
    mean.copyTo(out_, alive_);
    number_.copyTo(count_, alive_);
  }

  const Heights& own_;
  const std::map<int, Heights>& others_;
  cv::Mat sum_, number_, alive_, out_, count_;
  std::vector<cv::Mat> numbers_;  // frames of each level
  std::vector<Scale> scales_;
};

/// Mean of what was measured while the live server held a place constant: it found that it rests.
class Rest {
 public:
  Rest(const Relief& live, const Motion& motion, const Heights& own)
      : live_(live),
        motion_(motion),
        sum_(own.height_mm.mul(own.valid)),
        count_(own.valid.clone()) {}

  void add(const Relief& live, const Motion& motion, const Heights& measured) {
    if (!(live.rect == live_.rect) || motion.position_mm != motion_.position_mm ||
        motion.angle_rad != motion_.angle_rad)
      return;
    cv::Mat same;
    cv::Mat(viewHeights(live) == viewHeights(live_)).convertTo(same, CV_32F, 1.0 / 255.0);
    same = same.mul(measured.valid);
    sum_ += measured.height_mm.mul(same);
    count_ += same;
  }
  /// Replaces heights and counts where more frames than those of the live average count.
  void apply(cv::Mat& height_mm, cv::Mat& count) const {
    const cv::Mat more = (count_ > kHeldFrames) & (count_ >= count);
    const cv::Mat mean = sum_ / cv::max(count_, 1.0);
    mean.copyTo(height_mm, more);
    count_.copyTo(count, more);
  }

 private:
  const Relief& live_;
  const Motion& motion_;
  cv::Mat sum_, count_;
};

/// Returns the place of the object with this key in the frame; nullopt: none that can be used.
std::optional<std::size_t> findMeasured(const VisionResult& result, const ObjectKey& key) {
  const auto& objects = result.frame.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (makeKey(objects[i]) == key && result.measured[i] &&
        objects[i].motion.quality >= TrackedObject::kGoodQuality)
      return i;
  }
  return std::nullopt;
}

bool areAlike(const Relief& a, const Relief& b) {
  if (!(a.rect == b.rect) || a.mask != b.mask) return false;
  return std::equal(a.height_mm.begin(), a.height_mm.end(), b.height_mm.begin(),
                    [](float x, float y) { return std::abs(x - y) <= kSame_mm; });
}

}  // namespace

ReliefFusion::ReliefFusion(const FusionView& view)
    : view_(view),
      reach_(std::int64_t{view.workspace.width_px} * view.workspace.height_px > kLargePicture_px
                 ? kShortReach
                 : kReach) {}

void ReliefFusion::push(VisionResult result) { frames_.push_back(std::move(result)); }

std::optional<VisionResult> ReliefFusion::next(bool ended, bool wanted) {
  if (at_ >= frames_.size() || (!ended && at_ + reach_ >= frames_.size())) return std::nullopt;
  VisionResult out = frames_[at_];
  if (wanted) fuse(out.frame);
  frames_[at_].color.release();
  if (at_ < reach_) {
    ++at_;
  } else {
    frames_.pop_front();
  }
  return out;
}

void ReliefFusion::fuse(HapticFrame& frame) {
  std::map<ObjectKey, Sent> sent;
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    HapticObject& object = frame.objects[i];
    if (auto fused = fuseObject(object, i)) {
      object.relief = std::move(fused);
      object.changed_in_frame = frame.id;
    }
    const auto before = sent_.find(makeKey(object));
    if (before != sent_.end() && areAlike(*before->second.relief, *object.relief)) {
      object.relief = before->second.relief;
      object.changed_in_frame = before->second.changed_in_frame;
    } else {
      object.changed_in_frame = frame.id;
    }
    sent[makeKey(object)] = {object.relief, object.changed_in_frame};
  }
  sent_ = std::move(sent);
}

std::shared_ptr<const Relief> ReliefFusion::fuseObject(const HapticObject& object,
                                                       std::size_t index) const {
  const VisionResult& now = frames_[at_];
  const Relief& live = *object.relief;
  const double top_mm = view_.workspace.depth_mm;
  if (now.measured.empty() || object.motion.quality < TrackedObject::kGoodQuality) return nullptr;
  const Heights own = readHeights(now.measured[index] ? *now.measured[index] : live, top_mm);
  std::map<int, Heights> others;
  Rest rest(live, object.motion, own);
  for (std::size_t j = at_ - std::min(at_, reach_); j < std::min(frames_.size(), at_ + reach_ + 1);
       ++j) {
    const VisionResult& then = frames_[j];
    if (j == at_ || then.frame.epoch != now.frame.epoch) continue;
    const auto place = findMeasured(then, makeKey(object));
    if (!place) continue;
    const HapticObject& other = then.frame.objects[*place];
    const Relief& relief = *then.measured[*place];
    const Heights measured = readHeights(relief, top_mm);
    rest.add(*other.relief, other.motion, measured);
    const int distance = static_cast<int>(j) - static_cast<int>(at_);
    if (std::abs(distance) > kWindows.back()) continue;
    others[distance] =
        carryHeights(own, {live.rect, object.motion}, measured, {relief.rect, other.motion}, view_);
  }
  cv::Mat count;
  cv::Mat fused = Window(own, others).fuse(count);
  rest.apply(fused, count);
  // Where the live server averages over time, too, a shorter window is no gain.
  const cv::Mat held = cv::abs(viewHeights(live) - own.height_mm) > kRounding_mm;
  const cv::Mat use = (count > 1.0F) & (~held | (count >= kHeldFrames));
  if (cv::countNonZero(use) == 0) return nullptr;
  auto out = std::make_shared<Relief>(live);
  cv::Mat heights = viewHeights(*out);
  const cv::Mat cut = cv::min(cv::max(fused, 0.0), top_mm);
  cut.copyTo(heights, use);
  return out;
}

}  // namespace hapticast::server
