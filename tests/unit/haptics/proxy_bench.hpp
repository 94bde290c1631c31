// SPDX-License-Identifier: MIT
// A table for the proxy: still scenes, films of moving objects, and hands that are functions of
// time. One tick is 1 ms; forces are displacements (1 N/mm).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "client/haptics/contact/proxy_surface.hpp"
#include "tests/support/frame_builder.hpp"

namespace hapticast::client {

using HeightOf = std::function<double(const Vec2&)>;
using MaskOf = std::function<bool(const Vec2&)>;

inline constexpr double kDeepest_mm = 3.3;  // an Omni's peak at 1 N/mm

inline bool anywhere(const Vec2&) { return true; }
inline HeightOf level(double height_mm) {
  return [=](const Vec2&) { return height_mm; };
}
/// A square of +-half_mm about the middle of the picture.
inline PixelRect square(double half_mm) {
  const int half = static_cast<int>(half_mm / kWorkspace.mmPerPixel().x()) + 1;
  return {320 - half, 240 - half, 2 * half, 2 * half};
}
inline std::shared_ptr<const HeightField> relief(double half_mm, const HeightOf& height,
                                                 const MaskOf& mask = anywhere) {
  return makeField(square(half_mm), kWorkspace, height, mask);
}

inline constexpr double kSlant = 17.0 * M_PI / 180.0;
inline constexpr double kTop_mm = 12.0;

/// A flat box of +-10 mm, turned by 17 degrees.
inline MaskOf slantedBox() {
  return [](const Vec2& at) {
    return (Eigen::Rotation2Dd(-kSlant) * at).cwiseAbs().maxCoeff() < 10.0;
  };
}
/// A point of the box: `out` along the normal of its right wall, `along` the wall.
inline Vec3 ofBox(double out_mm, double along_mm, double z_mm) {
  const Vec2 at = Eigen::Rotation2Dd(kSlant) * Vec2(out_mm, along_mm);
  return {at.x(), at.y(), z_mm};
}

/// Hills of 0.5 mm, 3 mm apart.
inline double rough(const Vec2& at) {
  return 10.0 + 0.5 * std::sin(2.0 * M_PI * at.x() / 3.0) * std::cos(2.0 * M_PI * at.y() / 3.0);
}

/// A ball of 20 mm, cut off at 19 mm from its axis.
inline double sphere(const Vec2& at) { return std::sqrt(std::max(0.0, 400.0 - at.squaredNorm())); }
inline bool cap(const Vec2& at) { return at.norm() < 19.0; }

/// Random but smooth: three sines on each axis about a point of the surface.
class Wander {
 public:
  explicit Wander(std::uint64_t seed) : random_(seed) {
    for (double& f : rate_) f = std::uniform_real_distribution<double>(0.5, 4.0)(random_);
    for (double& p : phase_) p = std::uniform_real_distribution<double>(0.0, 6.28)(random_);
  }
  [[nodiscard]] double operator()(int axis, double t) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(3 * axis + k);
      sum += std::sin(2.0 * M_PI * rate_[i] * t + phase_[i]);
    }
    return sum / 3.0;
  }

 private:
  std::mt19937_64 random_;
  std::array<double, 9> rate_{}, phase_{};
};

/// Objects that stand still, touched tick by tick.
class Table {
 public:
  /// `at_mm` is where its reference point is; the relief is where its pixels are.
  InterpolatedObject& put(std::uint32_t id, std::shared_ptr<const HeightField> field,
                          const Vec3& at_mm = Vec3::Zero()) {
    fields_.push_back(std::move(field));
    objects_.push_back(std::make_unique<PlayObject>(makeObject(id, fields_.back().get(), at_mm)));
    InterpolatedObject& now = scene.objects[scene.object_count++];
    now = {};
    now.before = objects_.back().get();
    now.position_mm = at_mm;
    return now;
  }
  /// The object's frame is another one from now on.
  void show(std::size_t index, std::shared_ptr<const HeightField> field) {
    InterpolatedObject now = scene.objects[index];
    const PlayObject last = *now.before;
    fields_.push_back(std::move(field));
    objects_.push_back(std::make_unique<PlayObject>(last));
    objects_.back()->field = fields_.back().get();
    scene.objects[index].before = objects_.back().get();
  }
  PlayObject& object(std::size_t index) { return *objects_[index]; }
  Contact touch(const Vec3& hip_mm) {
    scene.play_time += Duration(1'000'000);
    Contact contact = proxies.computeContact(scene, hip_mm, kWorkspace, kDeepest_mm);
    most_samples = std::max(most_samples, proxies.samplesUsed());
    return contact;
  }
  /// Straight to a point at most `speed_mm` per tick; the last contact.
  Contact move(const Vec3& from_mm, const Vec3& to_mm, double speed_mm = 0.02) {
    const int ticks = static_cast<int>(std::ceil((to_mm - from_mm).norm() / speed_mm)) + 1;
    Contact contact;
    for (int i = 0; i <= ticks; ++i) {
      contact = touch(from_mm + (to_mm - from_mm) * (static_cast<double>(i) / ticks));
    }
    return contact;
  }

  Scene scene;
  ProxySurface proxies;
  int most_samples = 0;

 private:
  std::vector<std::shared_ptr<const HeightField>> fields_;
  std::vector<std::unique_ptr<PlayObject>> objects_;
};

/// A film at 25 frames/s: a function returns frame k, and the next frame is always known.
class Film {
 public:
  static constexpr double kFrame_s = 0.04;
  using Frame = std::function<std::vector<PlayObject>(double t_s)>;

  explicit Film(Frame frame, Interpolation interpolation = Interpolation::kHermite)
      : frame_(std::move(frame)), lookup_(*pool_, interpolation) {
    stream_.first_epoch = 1;
  }
  /// The scene one millisecond later; the first call is at time 0.
  const Scene& next() {
    while (sent_ * kFrame_s <= t_s() + 1.5 * kFrame_s) {
      PlayFrame frame;
      frame.epoch = 1;
      frame.id = static_cast<std::uint64_t>(sent_);
      frame.media_time = mediaTime(sent_ * kFrame_s);
      for (const PlayObject& object : frame_(sent_ * kFrame_s)) {
        frame.objects[frame.object_count++] = object;
      }
      EXPECT_TRUE(send(*pool_, frame));
      ++sent_;
    }
    return lookup_.at(mediaTime(1e-3 * ++tick_), stream_);
  }
  [[nodiscard]] double t_s() const { return 1e-3 * tick_; }
  Contact touch(const Vec3& hip_mm) {
    Contact contact = proxies.computeContact(next(), hip_mm, kWorkspace, kDeepest_mm);
    most_samples = std::max(most_samples, proxies.samplesUsed());
    return contact;
  }

  ProxySurface proxies;
  int most_samples = 0;

 private:
  Frame frame_;
  std::unique_ptr<FramePool> pool_ = std::make_unique<FramePool>();
  SceneInterpolator lookup_;
  StreamTiming stream_;
  int sent_ = 0;
  int tick_ = -1;
};

/// Relative RMS error over the ticks of true contact.
struct Error {
  double squared = 0.0;
  double truth = 0.0;
  void add(const Vec3& measured, const Vec3& true_value) {
    squared += (measured - true_value).squaredNorm();
    truth += true_value.squaredNorm();
  }
  [[nodiscard]] double relative() const { return std::sqrt(squared / truth); }
};

}  // namespace hapticast::client
