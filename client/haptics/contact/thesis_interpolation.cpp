// SPDX-License-Identifier: MIT
#include "client/haptics/contact/thesis_interpolation.hpp"

#include <algorithm>
#include <array>

#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {

/// Returns the deepest contact in one frame at its capture. Only objects that also exist in the
/// frame `now` count: a later object would grow out of nothing under the HIP.
Contact validateFrame(const PlayFrame* frame, const PlayFrame& now, const Vec3& hip_mm,
                      const Workspace& workspace, const PlayObject*& touched) noexcept {
  Contact deepest;
  touched = nullptr;
  if (frame == nullptr) return deepest;
  for (std::size_t i = 0; i < std::min(frame->object_count, kMaxObjects); ++i) {
    const PlayObject& object = frame->objects[i];
    if (findObject(&now, makeKey(object)) == nullptr) continue;
    InterpolatedObject still;
    still.before = &object;
    still.position_mm = object.motion.position_mm;
    still.angle_rad = object.motion.angle_rad;
    const Contact contact = computeObjectContact(SurfaceKind::kPerturbed, still, hip_mm, workspace);
    if (!contact.contact || (deepest.contact && contact.depth_mm <= deepest.depth_mm)) continue;
    deepest = contact;
    deepest.object = nullptr;  // `still` ends here
    touched = &object;
  }
  return deepest;
}

/// Uniform Catmull-Rom spline between p1 and p2.
Vec3 catmullRom(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3& p3, double s) noexcept {
  return p1 + 0.5 * s *
                  (p2 - p0 +
                   s * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + s * (3.0 * (p1 - p2) + p3 - p0)));
}

/// Returns the touched object at play time, for the dynamic force.
InterpolatedObject objectNow(const PlayObject& touched, const PlayFrame& from, const PlayFrame* to,
                             double s) noexcept {
  InterpolatedObject now;
  const PlayObject* const before = findObject(&from, makeKey(touched));
  const PlayObject* const after = findObject(to, makeKey(touched));
  now.before = before != nullptr ? before : &touched;
  now.after = before != nullptr ? after : nullptr;
  now.blend = now.after != nullptr ? s : 0.0;
  now.position_mm = now.before->motion.position_mm;
  now.angle_rad = now.before->motion.angle_rad;
  now.acceleration_mm_s2 = now.before->motion.acceleration_mm_s2;
  if (now.after != nullptr) {
    now.acceleration_mm_s2 =
        (1.0 - s) * now.acceleration_mm_s2 + s * now.after->motion.acceleration_mm_s2;
  }
  return now;
}

/// Contacts of the HIP in the four frames around play time; `s` is the share of play time between
/// the second and the third.
struct Around {
  std::array<Contact, 4> at;
  std::array<const PlayObject*, 4> touched{};
  double s = 0.0;

  /// Returns the cubic if `cubic`, else the linear interpolation; constant without a third frame.
  [[nodiscard]] Vec3 displacement_mm(bool cubic) const noexcept {
    if (!cubic) return (1.0 - s) * at[1].displacement_mm + s * at[2].displacement_mm;
    return catmullRom(at[0].displacement_mm, at[1].displacement_mm, at[2].displacement_mm,
                      at[3].displacement_mm, s);
  }
};

Around readNeighbourhood(const std::array<const PlayFrame*, 4>& frames, MediaTime play_time,
                         const Vec3& hip_mm, const Workspace& workspace) noexcept {
  Around around;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    around.at[k] = validateFrame(frames[k], *frames[1], hip_mm, workspace, around.touched[k]);
  }
  if (frames[2] == nullptr) {
    around.at[2] = around.at[1];
    return around;
  }
  const double interval_s = secondsBetween(frames[1]->media_time, frames[2]->media_time);
  const double time_s = secondsBetween(frames[1]->media_time, play_time);
  around.s = std::clamp(time_s / std::max(interval_s, 1e-9), 0.0, 1.0);
  return around;
}

}  // namespace

/// Stores the HIP at the begin of an interval. Returns true if the interval is a new one.
bool ThesisInterpolation::enter(const PlayFrame& from, const Vec3& hip_mm) noexcept {
  const bool new_interval = !entered_ || from.epoch != epoch_ || from.id != frame_id_;
  if (new_interval) frozen_hip_mm_ = hip_mm;
  entered_ = true;
  epoch_ = from.epoch;
  frame_id_ = from.id;
  return new_interval;
}

Contact ThesisInterpolation::evaluate(const SceneInterpolator& lookup, MediaTime play_time,
                                      const Vec3& hip_mm, const Workspace& workspace) noexcept {
  const std::array<const PlayFrame*, 4> frames = lookup.neighbours(play_time);
  const PlayFrame* const from = frames[1];
  if (from == nullptr) return {};
  const bool new_epoch = !entered_ || from->epoch != epoch_;
  const bool new_interval = enter(*from, hip_mm);

  const Around around = readNeighbourhood(frames, play_time, frozen_hip_mm_, workspace);
  const auto& at = around.at;
  const double s = around.s;
  Contact contact = s < 0.5 ? at[1] : at[2];
  contact.displacement_mm =
      around.displacement_mm(frames[0] != nullptr && frames[2] != nullptr && frames[3] != nullptr);
  const PlayObject* const object =
      around.touched[1] != nullptr ? around.touched[1] : around.touched[2];
  // The cubic may become negative beside a step in time: no pull. The same for a contact in frame
  // i-1 or i+2 only.
  if (object == nullptr || !(contact.displacement_mm.z() > 0.0)) return {};
  const Vec3 normal = (1.0 - s) * at[1].depth_mm * at[1].normal + s * at[2].depth_mm * at[2].normal;
  if (normal.norm() > 0.0) contact.normal = normal.normalized();
  contact.depth_mm = contact.displacement_mm.dot(contact.normal);
  contact.surface_velocity_mm_s.setZero();
  contact.stiffness_factor = std::max(at[1].stiffness_factor, at[2].stiffness_factor);
  contact.contact = true;
  contact.jump = new_epoch || (new_interval && findObject(frames[0], makeKey(*object)) == nullptr);
  object_ = objectNow(*object, *from, frames[2], s);
  contact.object = &object_;
  return contact;
}

}  // namespace hapticast::client
