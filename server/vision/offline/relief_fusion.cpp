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

constexpr std::array<int, 5> kLevels{1, 2, 4, 8, 16};  // frames on each side
constexpr int kTest_px = 9;     // chosen: width of the box whose means are compared
constexpr int kNoise_px = 33;   // chosen: width of the box over which the noise is measured
constexpr double kSigmas = 2.0; // measured: the widest interval that never costs accuracy
constexpr double kRounding_mm = 1e-4;    // of heights as floats
constexpr double kMedianOfSquare = 0.455;  // median of the square of a standard normal value
constexpr double kMostNoise = 2.0;       // chosen: local noise over that of the whole object
// Frames in the average of the static-region filter (Tile::kFrames): fewer are no gain at rest.
constexpr float kHeldFrames = 16.0F;
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

/// Returns the matrix from pixels of `to` (a rectangle at the motion `now`) to those of `from`.
cv::Matx23d findWarp(const PixelRect& to, const Motion& now, const PixelRect& from,
                     const Motion& then, const Workspace& workspace) {
  const double turn_rad = then.angle_rad - now.angle_rad;
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  const auto carry = [&](double u, double v) {
    const Vec2 r = workspace.toNominal({u + to.u + 0.5, v + to.v + 0.5}) - now.position_mm.head<2>();
    const Vec2 at = then.position_mm.head<2>() + Vec2(c * r.x() - s * r.y(), s * r.x() + c * r.y());
    const Vec2 px = workspace.toImage(at);
    return Vec2(px.x() - 0.5 - from.u, px.y() - 0.5 - from.v);
  };
  const Vec2 o = carry(0, 0);
  const Vec2 x = carry(1, 0) - o;
  const Vec2 y = carry(0, 1) - o;
  return {x.x(), y.x(), o.x(), x.y(), y.y(), o.y()};
}

// Returns the heights of another frame, carried to the rectangle of this one.
Heights carryHeights(const Heights& then, const cv::Matx23d& warp, const cv::Size& size,
                     double rise_mm) {
  Heights out;
  const cv::Matx23d whole(1, 0, std::round(warp(0, 2)), 0, 1, std::round(warp(1, 2)));
  const bool is_whole = cv::norm(warp - whole, cv::NORM_INF) < 1e-6;
  cv::Mat support = then.valid;
  if (!is_whole) cv::erode(support, support, cv::Mat::ones(3, 3, CV_8UC1));
  const int flags = cv::WARP_INVERSE_MAP | (is_whole ? cv::INTER_NEAREST : cv::INTER_CUBIC);
  cv::warpAffine(then.height_mm, out.height_mm, warp, size, flags);
  cv::warpAffine(support, out.valid, warp, size,
                 cv::WARP_INVERSE_MAP | (is_whole ? cv::INTER_NEAREST : cv::INTER_LINEAR));
  cv::threshold(out.valid, out.valid, 0.999, 1.0, cv::THRESH_BINARY);
  out.height_mm += rise_mm;
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

/// Returns the variance of one frame's means over a test box, mm^2, of three successive frames.
cv::Mat measureVariance(const Heights& a, const Heights& b, const Heights& c) {
  const cv::Mat valid = a.valid.mul(b.valid).mul(c.valid);
  const cv::Mat second = a.height_mm - 2.0 * b.height_mm + c.height_mm;
  const cv::Mat mean = averageInBox(second, valid, kTest_px);
  const cv::Mat square = mean.mul(mean) / 6.0;
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
    const cv::Mat variance = measure();
    if (!variance.empty()) {
      sum_ = own_.height_mm.mul(own_.valid);
      number_ = own_.valid.clone();
      alive_ = own_.valid > 0;
      before_.push_back({averageInBox(own_.height_mm, own_.valid, kTest_px), own_.valid.clone()});
      int reached = 0;
      for (const int level : kLevels) {
        for (int k = reached + 1; k <= level; ++k) {
          add(-k);
          add(k);
        }
        reached = level;
        if (cv::countNonZero(alive_) == 0) break;
        acceptLevel(variance);
      }
    }
    count = count_;
    return out_;
  }

 private:
  struct Level {
    cv::Mat mean;    // over a test box
    cv::Mat number;  // frames
  };

  [[nodiscard]] const Heights* at(int k) const {
    if (k == 0) return &own_;
    const auto found = others_.find(k);
    return found == others_.end() ? nullptr : &found->second;
  }
  [[nodiscard]] cv::Mat measure() const {
    for (const int first : {-1, 0, -2}) {
      const Heights* const a = at(first);
      const Heights* const b = at(first + 1);
      const Heights* const c = at(first + 2);
      if (a != nullptr && b != nullptr && c != nullptr) return measureVariance(*a, *b, *c);
    }
    return {};
  }
  void add(int k) {
    const Heights* const other = at(k);
    if (other == nullptr) return;
    sum_ += other->height_mm.mul(other->valid);
    number_ += other->valid;
  }
  void acceptLevel(const cv::Mat& variance) {
    const cv::Mat mean = sum_ / cv::max(number_, 1.0);
    Level now{averageInBox(mean, own_.valid, kTest_px), number_.clone()};
    for (const Level& narrower : before_) {
      const cv::Mat apart = now.mean - narrower.mean;
      const cv::Mat allowed =
          kSigmas * kSigmas *
              variance.mul(1.0 / cv::max(narrower.number, 1.0) - 1.0 / cv::max(now.number, 1.0)) +
          kRounding_mm * kRounding_mm;
      alive_ &= apart.mul(apart) <= allowed;
    }
    mean.copyTo(out_, alive_);
    number_.copyTo(count_, alive_);
    before_.push_back(std::move(now));
  }

  const Heights& own_;
  const std::map<int, Heights>& others_;
  cv::Mat sum_, number_, alive_, out_, count_;
  std::vector<Level> before_;
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

void ReliefFusion::push(VisionResult result) { frames_.push_back(std::move(result)); }

std::optional<VisionResult> ReliefFusion::next(bool ended, bool wanted) {
  if (at_ >= frames_.size() || (!ended && at_ + kReach >= frames_.size())) return std::nullopt;
  VisionResult out = frames_[at_];
  if (wanted) fuse(out.frame);
  frames_[at_].color.release();
  if (at_ < kReach) {
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
  const double top_mm = workspace_.depth_mm;
  if (now.measured.empty() || object.motion.quality < TrackedObject::kGoodQuality) return nullptr;
  const Heights own = readHeights(now.measured[index] ? *now.measured[index] : live, top_mm);
  std::map<int, Heights> others;
  for (std::size_t j = at_ - std::min(at_, kReach);
       j < std::min(frames_.size(), at_ + kReach + 1); ++j) {
    const VisionResult& then = frames_[j];
    if (j == at_ || then.frame.epoch != now.frame.epoch) continue;
    const auto place = findMeasured(then, makeKey(object));
    if (!place) continue;
    const Motion& motion = then.frame.objects[*place].motion;
    const Relief& measured = *then.measured[*place];
    others[static_cast<int>(j) - static_cast<int>(at_)] = carryHeights(
        readHeights(measured, top_mm),
        findWarp(live.rect, object.motion, measured.rect, motion, workspace_),
        own.height_mm.size(), object.motion.position_mm.z() - motion.position_mm.z());
  }
  cv::Mat count;
  const cv::Mat fused = Window(own, others).fuse(count);
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
