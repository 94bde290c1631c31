// SPDX-License-Identifier: MIT
#include "client/haptics/contact/proxy_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {

constexpr double kMostFriction = 1.5;  // of the wire as well
// What moves on for longer than this without being felt has jumped.
constexpr double kLongestTick_s = 5e-3;
constexpr double kFastestObject_mm_s = 1500.0;  // nor does the chain believe in more
constexpr double kWeight_mm = 1e-9;             // of a contact whose displacement has yet to grow
constexpr int kSweeps = 8;                      // chosen: two walls within 3 % of the exact way

double coefficient(double given) noexcept {
  return given > 0.0 ? std::min(given, kMostFriction) : 0.0;  // a NaN is none
}

Vec3 rotated(const Vec3& v, double c, double s) noexcept {
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

/// How far `step` is from any mean of `a` and `b`.
double computeDistanceToLine(const Vec3& step, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 span = b - a;
  const double square = span.squaredNorm();
  const double t = square > 0.0 ? std::clamp((step - a).dot(span) / square, 0.0, 1.0) : 0.0;
  return (step - a - t * span).norm();
}

/// Contacts that act together.
struct Sum {
  Contact contact;
  Vec3 normals = Vec3::Zero();
  Vec3 velocities = Vec3::Zero();
  double weights = 0.0;
  double longest_mm = -1.0;
  std::array<Vec3, kMaxObjects> directions;
  std::array<double, kMaxObjects> lengths_mm;
  std::size_t count = 0;

  void add(const ProxyTouch& touch, const InterpolatedObject& object, const Vec3& at_mm) noexcept {
    const bool turns = object.angle_rad != 0.0;
    const double c = turns ? std::cos(object.angle_rad) : 1.0;
    const double s = turns ? std::sin(object.angle_rad) : 0.0;
    const Vec3 displacement_mm = rotated(touch.displacement_mm, c, s);
    const double length_mm = displacement_mm.norm();
    const double weight = length_mm + kWeight_mm;
    const Vec3 arm_mm = rotated(at_mm, c, s);
    const double turn = object.angular_velocity_rad_s;
    contact.contact = true;
    contact.displacement_mm += displacement_mm;  // of one object: its own
    if (length_mm > 0.0) {
      directions[count] = displacement_mm / length_mm;
      lengths_mm[count++] = length_mm;
    }
    normals += weight * rotated(touch.normal, c, s);
    velocities += weight * (object.velocity_mm_s + rotated(touch.shape_velocity_mm_s, c, s) +
                            turn * Vec3(-arm_mm.y(), arm_mm.x(), 0.0));
    weights += weight;
    if (length_mm <= longest_mm) return;
    longest_mm = length_mm;
    contact.object = &object;
  }
  [[nodiscard]] Contact result() noexcept {
    if (!contact.contact) return contact;
    if (count > 1) contact.displacement_mm = shared();
    const double length = normals.norm();
    // Walls that face each other have no common normal.
    contact.normal = length > kWeight_mm ? Vec3(normals / length) : Vec3(Vec3::UnitZ());
    contact.surface_velocity_mm_s = velocities / weights;
    contact.depth_mm = contact.displacement_mm.dot(contact.normal);
    return contact;
  }

 private:
  /// The shortest way that takes the tip out of all of them: the longest of objects that push
  /// alike, the sum of walls across each other; walls that face each other push against each other.
  /// By coordinate ascent on what each contributes, which is the same for any order of the objects.
  [[nodiscard]] Vec3 shared() const noexcept {
    std::array<std::array<double, kMaxObjects>, kMaxObjects> alike;
    std::array<double, kMaxObjects> part_mm;
    for (std::size_t i = 0; i < count; ++i) {
      double all = 0.0;
      for (std::size_t j = 0; j < count; ++j) {
        alike[i][j] = i == j ? 0.0 : std::max(0.0, directions[i].dot(directions[j]));
        all += alike[i][j];
      }
      part_mm[i] = lengths_mm[i] / (1.0 + all);  // alike and equally long: that is it already
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t i = 0; i < count; ++i) {
        double others_mm = 0.0;
        for (std::size_t j = 0; j < count; ++j) others_mm += part_mm[j] * alike[i][j];
        part_mm[i] = std::max(0.0, lengths_mm[i] - others_mm);
      }
    }
    Vec3 path_mm = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) path_mm += part_mm[i] * directions[i];
    return path_mm;
  }
};

}  // namespace

Friction toFriction(const Material& material) noexcept {
  const auto& sticking = material.static_friction;
  const auto& sliding = material.dynamic_friction;
  const double most = coefficient(sticking.value_or(sliding.value_or(kDefaultFriction)));
  return {most, std::min(coefficient(sliding.value_or(most)), most)};
}

/// Of what it touches, changing slowly while it does.
Friction ProxySurface::friction(ProxySlot& tied, const InterpolatedObject& object) const noexcept {
  const bool in_contact = tied.touch.displacement_mm != Vec3::Zero();
  const Friction wanted =
      friction_ ? Friction{*friction_, *friction_} : toFriction(object.before->material);
  const double sticking = tied.sticking.step(wanted.sticking, in_contact);
  return {sticking, std::min(tied.sliding.step(wanted.sliding, in_contact), sticking)};
}

void ProxySurface::restart() noexcept {
  just_restarted_ = true;
  ++tick_;  // nothing was there in the last one
}

ProxySurface::ProxySlot* ProxySurface::isKnown(std::uint64_t key) noexcept {
  for (ProxySlot& tied : tied_) {
    if (tied.key == key && tied.tick + 1 == tick_) return &tied;
  }
  return nullptr;
}

/// One whose object is not in this scene. There are as many as a scene has objects.
ProxySurface::ProxySlot& ProxySurface::unused() noexcept {
  return *std::min_element(tied_.begin(), tied_.end(),
                           [](const ProxySlot& a, const ProxySlot& b) { return a.tick < b.tick; });
}

/// The pose changed by more than the velocities of before and now explain (a frame that came late,
/// a correction, a number that is none); an impact in between is a mean of both.
bool ProxySurface::poseJumped(const ProxySlot& tied, const InterpolatedObject& object,
                              double arm_mm, double elapsed_s) noexcept {
  const auto path_mm = [=](const Vec3& velocity_mm_s) -> Vec3 {
    const double speed_mm_s = velocity_mm_s.norm();
    const double share = speed_mm_s > kFastestObject_mm_s ? kFastestObject_mm_s / speed_mm_s : 1.0;
    return velocity_mm_s * (share * elapsed_s);
  };
  const Vec3 step_mm = object.position_mm - tied.position_mm;
  const double turn_rad = object.angle_rad - tied.angle_rad;
  // The usual case first: it moves on as it did, without a turn.
  constexpr double kNear_mm2 = 0.25 * Proxy::kJump_mm * Proxy::kJump_mm;
  if (turn_rad == 0.0 && object.angular_velocity_rad_s == 0.0 &&
      step_mm.squaredNorm() < kNear_mm2) {
    return false;
  }
  const double moved_mm =
      computeDistanceToLine(step_mm, path_mm(tied.velocity_mm_s), path_mm(object.velocity_mm_s));
  const double short_rad = std::remainder(turn_rad, 2.0 * std::numbers::pi);
  const double was_rad = tied.angular_velocity_rad_s * elapsed_s;
  const double is_rad = object.angular_velocity_rad_s * elapsed_s;
  const double turned_rad = std::abs(
      short_rad - std::clamp(short_rad, std::min(was_rad, is_rad), std::max(was_rad, is_rad)));
  return !(moved_mm + turned_rad * arm_mm <= Proxy::kJump_mm);
}

void ProxySurface::updateObject(ProxySlot& tied, const InterpolatedObject& object,
                                const Vec3& hip_mm, const Workspace& workspace,
                                double elapsed_s) noexcept {
  const bool was_there = tied.tick + 1 == tick_;
  if (!was_there) {
    tied.relief = {};  // of another world, perhaps
    tied.proxy.restart(!just_restarted_);
    tied.touch = {};
  }
  if (tied.relief.update(object, workspace)) tied.proxy.forgetSamples();
  const Vec3 arm_mm = hip_mm - object.position_mm;
  const bool turns = object.angle_rad != 0.0;
  const Vec3 own_mm =
      turns ? rotated(arm_mm, std::cos(object.angle_rad), -std::sin(object.angle_rad)) : arm_mm;
  const bool jumped = was_there && poseJumped(tied, object, arm_mm.head<2>().norm(), elapsed_s);
  tied.key = makeKey(*object.before);
  tied.tick = tick_;
  tied.position_mm = object.position_mm;
  tied.velocity_mm_s = object.velocity_mm_s;
  tied.angle_rad = object.angle_rad;
  tied.angular_velocity_rad_s = object.angular_velocity_rad_s;
  if (!own_mm.allFinite()) {
    tied.proxy.restart(true);
    tied.touch = {};
  } else if (!tied.proxy.clear(tied.relief, own_mm)) {
    near_[near_count_++] = {&tied, &object, own_mm, jumped};
  }
}

void ProxySurface::gather(const Scene& scene, const Vec3& hip_mm,
                          const Workspace& workspace) noexcept {
  const double elapsed_s =
      std::clamp(secondsBetween(play_time_, scene.play_time), 0.0, kLongestTick_s);
  play_time_ = scene.play_time;
  near_count_ = 0;
  std::array<const InterpolatedObject*, kMaxObjects> arrived;
  std::size_t arrived_count = 0;
  for (std::size_t i = 0; i < std::min(scene.object_count, kMaxObjects); ++i) {
    const InterpolatedObject& object = scene.objects[i];
    if (!shows(object.before)) continue;
    if (ProxySlot* const tied = isKnown(makeKey(*object.before))) {
      updateObject(*tied, object, hip_mm, workspace, elapsed_s);
    } else {
      arrived[arrived_count++] = &object;
    }
  }
  for (std::size_t i = 0; i < arrived_count; ++i) {
    updateObject(unused(), *arrived[i], hip_mm, workspace, elapsed_s);
  }
}

Contact ProxySurface::computeContact(const Scene& scene, const Vec3& hip_mm,
                                     const Workspace& workspace, double deepest_mm) noexcept {
  used_ = 0;
  if (scene.jumped || !hip_mm.allFinite()) restart();
  ++tick_;
  Sum sum;
  if (hip_mm.allFinite()) {
    gather(scene, hip_mm, workspace);
    just_restarted_ = false;
  } else {
    near_count_ = 0;
  }
  // Where too many objects lie over each other, some are held for a tick, another first each time.
  ++round_robin_;
  for (std::size_t i = 0; i < near_count_; ++i) {
    const Candidate& near = near_[(round_robin_ + i) % near_count_];
    ProxySlot& tied = *near.tied;
    const int left = kSamples - used_;
    if (left > 0) {
      const int fair = std::max(1, left / static_cast<int>(near_count_ - i));
      tied.touch = tied.proxy.update(
          tied.relief, {near.hip_mm, friction(tied, *near.object), fair, near.jumped, deepest_mm});
      used_ += tied.proxy.samplesUsed();
    }
  }
  for (std::size_t i = 0; i < near_count_; ++i) {
    const ProxySlot& tied = *near_[i].tied;
    if (tied.touch.contact) sum.add(tied.touch, *near_[i].object, tied.proxy.position_mm());
  }
  Contact contact = sum.result();
  contact.jump = scene.jumped;
  return contact;
}

}  // namespace hapticast::client
