// SPDX-License-Identifier: MIT
// Frames for tests of the real-time renderer: reliefs from functions, sent through a FramePool as a
// receiver would.
#pragma once

#include <functional>
#include <memory>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/scene_interpolator.hpp"

namespace hapticast::client {

inline const Workspace kWorkspace;

/// A field over `rect` with heights from nominal mm, masked by a function of nominal mm.
inline std::shared_ptr<const HeightField> makeField(
    const PixelRect& rect, const Workspace& workspace,
    const std::function<double(const Vec2&)>& height,
    const std::function<bool(const Vec2&)>& mask) {
  Relief relief;
  relief.rect = rect;
  for (int v = rect.v; v < rect.v + rect.height; ++v) {
    for (int u = rect.u; u < rect.u + rect.width; ++u) {
      const Vec2 at = workspace.toNominal({u + 0.5, v + 0.5});
      const bool covered = mask(at);
      relief.mask.push_back(covered ? 1 : 0);
      relief.height_mm.push_back(covered ? static_cast<float>(height(at)) : 0.0F);
    }
  }
  return std::make_shared<const HeightField>(HeightField::prepare(relief, workspace));
}

/// A spherical cap of radius_mm about (x, y, z), cut off at cut_mm from its axis.
inline std::shared_ptr<const HeightField> makeBall(const Vec3& centre_mm, double radius_mm,
                                                   double cut_mm, const Workspace& workspace) {
  const Vec2 axis = centre_mm.head<2>();
  const Vec2 px = workspace.toImage(axis);
  const int half = static_cast<int>(cut_mm / workspace.mmPerPixel().x()) + 2;
  const PixelRect rect{static_cast<int>(px.x()) - half, static_cast<int>(px.y()) - half, 2 * half,
                       2 * half};
  return makeField(
      rect, workspace,
      [=](const Vec2& at) {
        return centre_mm.z() + std::sqrt(radius_mm * radius_mm - (at - axis).squaredNorm());
      },
      [=](const Vec2& at) { return (at - axis).norm() < cut_mm; });
}

inline PlayObject makeObject(std::uint32_t id, const HeightField* field, const Vec3& position_mm,
                             const Vec3& velocity_mm_s = Vec3::Zero(),
                             const Vec3& acceleration_mm_s2 = Vec3::Zero()) {
  PlayObject object;
  object.id = id;
  object.field = field;
  object.motion.position_mm = position_mm;
  object.motion.velocity_mm_s = velocity_mm_s;
  object.motion.acceleration_mm_s2 = acceleration_mm_s2;
  return object;
}

inline PlayFrame makeFrame(std::uint32_t epoch, std::uint64_t id, double time_s,
                           std::initializer_list<PlayObject> objects) {
  PlayFrame frame;
  frame.epoch = epoch;
  frame.id = id;
  frame.media_time = mediaTime(time_s);
  for (const PlayObject& object : objects) frame.objects[frame.object_count++] = object;
  return frame;
}

/// The receiver's part: false when the loop holds every slot.
inline bool send(FramePool& pool, const PlayFrame& frame) {
  FramePool::Index index = 0;
  if (!pool.acquire(index)) return false;
  pool.slot(index).frame = frame;
  pool.publish(index);
  return true;
}

/// How many slots the receiver could fill now. Gives them back by way of frames of a void epoch 0.
inline std::size_t freeSlots(FramePool& pool, SceneInterpolator& lookup, MediaTime play_time,
                             StreamTiming stream) {
  std::size_t count = 0;
  while (send(pool, makeFrame(0, 0, 0.0, {}))) ++count;
  stream.first_epoch = std::max(stream.first_epoch, 1U);
  (void)lookup.at(play_time, stream);
  return count;
}

}  // namespace hapticast::client
