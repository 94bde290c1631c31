// SPDX-License-Identifier: MIT
#include "client/haptics/contact/proxy_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {

constexpr double kMostFriction = 1.5;  // the wire has the same limit
// Play time that advances by more than this in a tick counts as this much. The rest is a jump.
constexpr double kLongestTick_s = 5e-3;
constexpr double kFastestObject_mm_s = 1500.0;  // the chain limits surfaces to the same speed
constexpr double kWeight_mm = 1e-9;             // weight of a contact without a displacement yet
constexpr int kSweeps = 8;                      // chosen: exact to 3 % for two walls

double coefficient(double given) noexcept {
  return given > 0.0 ? std::min(given, kMostFriction) : 0.0;  // NaN counts as 0
}

/// Returns the distance of `step` from the segment between `a` and `b`.
double computeDistanceToLine(const Vec3& step, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 span = b - a;
  const double square = span.squaredNorm();
  const double t = square > 0.0 ? std::clamp((step - a).dot(span) / square, 0.0, 1.0) : 0.0;
  return (step - a - t * span).norm();
}

/// Contacts that act together, and their mean.
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
    const Vec3 displacement_mm = rotate(touch.displacement_mm, c, s);
    const double length_mm = displacement_mm.norm();
    const double weight = length_mm + kWeight_mm;
    const Vec3 arm_mm = rotate(at_mm, c, s);
    const double turn = object.angular_velocity_rad_s;
    contact.contact = true;
    contact.displacement_mm += displacement_mm;  // final for a single object
    if (length_mm > 0.0) {
      directions[count] = displacement_mm / length_mm;
      lengths_mm[count++] = length_mm;
    }
    normals += weight * rotate(touch.normal, c, s);
    velocities += weight * (object.velocity_mm_s + rotate(touch.shape_velocity_mm_s, c, s) +
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
    // Opposite walls have no common normal.
    contact.normal = length > kWeight_mm ? Vec3(normals / length) : Vec3(Vec3::UnitZ());
    contact.surface_velocity_mm_s = velocities / weights;
    contact.depth_mm = contact.displacement_mm.dot(contact.normal);
    return contact;
  }

 private:
  /// Returns the shortest displacement that moves the HIP out of all objects. Objects that push
  /// alike count once, by the longest displacement. Walls across each other add up, and opposite
  /// walls compete. Method: coordinate ascent on the contribution of each object.
  [[nodiscard]] Vec3 shared() const noexcept {
    std::array<std::array<double, kMaxObjects>, kMaxObjects> alike;
    std::array<double, kMaxObjects> part_mm;
    for (std::size_t i = 0; i < count; ++i) {
      double all = 0.0;
      for (std::size_t j = 0; j < count; ++j) {
        alike[i][j] = i == j ? 0.0 : std::max(0.0, directions[i].dot(directions[j]));
        all += alike[i][j];
      }
      part_mm[i] = lengths_mm[i] / (1.0 + all);  // final for objects alike in push and length
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

/// Returns the friction of the touched object; in contact it changes gradually.
Friction ProxySurface::friction(ProxySlot& tied, const InterpolatedObject& object) const noexcept {
  const bool in_contact = tied.touch.displacement_mm != Vec3::Zero();
  const Friction wanted =
      friction_ ? Friction{*friction_, *friction_} : toFriction(object.before->material);
  const double sticking = tied.sticking.step(wanted.sticking, in_contact);
  return {sticking, std::min(tied.sliding.step(wanted.sliding, in_contact), sticking)};
}

void ProxySurface::restart() noexcept {
  ++tick_;  // the slots of the last tick no longer count
}

void ProxySurface::ProxySlot::restart() noexcept {
  proxy.restart();
  touch = {};
  arrived = true;
}

void ProxySurface::ProxySlot::setPose(const InterpolatedObject& object) noexcept {
  position_mm = object.position_mm;
  velocity_mm_s = object.velocity_mm_s;
  angle_rad = object.angle_rad;
  angular_velocity_rad_s = object.angular_velocity_rad_s;
}

ProxySurface::ProxySlot* ProxySurface::isKnown(std::uint64_t key) noexcept {
  for (ProxySlot& tied : tied_) {
    if (tied.key == key && tied.tick + 1 == tick_) return &tied;
  }
  return nullptr;
}

/// Returns the slot that was unused for longest. There are as many slots as objects in a scene.
ProxySurface::ProxySlot& ProxySurface::findUnused() noexcept {
  return *std::min_element(tied_.begin(), tied_.end(),
                           [](const ProxySlot& a, const ProxySlot& b) { return a.tick < b.tick; });
}

/// Returns the slot whose contact `object` continues, or null: of the objects that vanished in this
/// tick, that with the longest displacement, if the surface of `object` is there. Moves the proxy
/// of that slot into the frame of `object`.
ProxySurface::ProxySlot* ProxySurface::findContinued(const InterpolatedObject& object,
                                                     const Workspace& workspace) noexcept {
  ProxySlot* vanished = nullptr;
  double longest_mm2 = 0.0;
  for (ProxySlot& tied : tied_) {
    const double length_mm2 = tied.touch.contact ? tied.touch.displacement_mm.squaredNorm() : 0.0;
    if (tied.tick + 1 != tick_ || length_mm2 <= longest_mm2) continue;
    vanished = &tied;
    longest_mm2 = length_mm2;
  }
  if (vanished == nullptr) return nullptr;
  MovingRelief relief;
  (void)relief.update(object, workspace);
  const double turn_rad = vanished->angle_rad - object.angle_rad;
  const Vec3 shift_mm = rotate(vanished->position_mm - object.position_mm,
                               std::cos(object.angle_rad), -std::sin(object.angle_rad));
  if (!vanished->proxy.continueOn(relief, std::cos(turn_rad), std::sin(turn_rad), shift_mm))
    return nullptr;
  vanished->setPose(object);
  return vanished;
}

/// Returns true if the pose changed by more than the velocities of this tick and the last explain.
/// Causes are a late frame, a correction, or NaN. With an impact in between, any mean of the two
/// velocities explains the change.
bool ProxySurface::poseJumped(const ProxySlot& tied, const InterpolatedObject& object,
                              double arm_mm, double elapsed_s) noexcept {
  const auto path_mm = [=](const Vec3& velocity_mm_s) -> Vec3 {
    const double speed_mm_s = velocity_mm_s.norm();
    const double share = speed_mm_s > kFastestObject_mm_s ? kFastestObject_mm_s / speed_mm_s : 1.0;
    return velocity_mm_s * (share * elapsed_s);
  };
  const Vec3 step_mm = object.position_mm - tied.position_mm;
  const double turn_rad = object.angle_rad - tied.angle_rad;
  // The usual case first: a steady motion without a turn.
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
    tied.relief = {};  // the slot may hold the relief of another object
    tied.restart();
  }
  if (tied.relief.update(object, workspace)) tied.proxy.forgetSamples();
  const Vec3 arm_mm = hip_mm - object.position_mm;
  const bool turns = object.angle_rad != 0.0;
  const Vec3 own_mm =
      turns ? rotate(arm_mm, std::cos(object.angle_rad), -std::sin(object.angle_rad)) : arm_mm;
  const bool jumped = was_there && poseJumped(tied, object, arm_mm.head<2>().norm(), elapsed_s);
  tied.key = makeKey(*object.before);
  tied.tick = tick_;
  tied.setPose(object);
  if (!own_mm.allFinite()) {
    tied.restart();
  } else if (tied.proxy.clear(tied.relief, own_mm)) {
    tied.arrived = false;
  } else {
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
    ProxySlot* const continued = findContinued(*arrived[i], workspace);
    updateObject(continued != nullptr ? *continued : findUnused(), *arrived[i], hip_mm, workspace,
                 elapsed_s);
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
  } else {
    near_count_ = 0;
  }
  // If the sample budget runs out, the remaining objects hold their result for a tick. Another
  // object is first in each tick.
  ++round_robin_;
  bool appeared = false;
  for (std::size_t i = 0; i < near_count_; ++i) {
    const Candidate& near = near_[(round_robin_ + i) % near_count_];
    ProxySlot& tied = *near.tied;
    const int left = kSamples - used_;
    if (left > 0) {
      const int fair = std::max(1, left / static_cast<int>(near_count_ - i));
      tied.touch = tied.proxy.update(
          tied.relief, {near.hip_mm, friction(tied, *near.object), fair, near.jumped, deepest_mm});
      used_ += tied.proxy.samplesUsed();
      appeared = appeared || (tied.arrived && tied.touch.contact);
      tied.arrived = false;
    }
  }
  for (std::size_t i = 0; i < near_count_; ++i) {
    const ProxySlot& tied = *near_[i].tied;
    if (tied.touch.contact) sum.add(tied.touch, *near_[i].object, tied.proxy.position_mm());
  }
  Contact contact = sum.result();
  contact.jump = scene.jumped || appeared;
  return contact;
}

}  // namespace hapticast::client
