// SPDX-License-Identifier: MIT
#include "common/library/frame_import.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/library/require.hpp"
#include "common/text.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

MediaTime importTime(double time_s, const char* what) {
  constexpr double kMost_s = 1e-9 * static_cast<double>(limits::kTime_ns);
  return mediaTime(requireRange(time_s, -kMost_s, kMost_s, what));
}

template <class Vector>
Vector requireLength(const Vector& vector, double limit, const char* what) {
  require(vector.allFinite() && static_cast<double>(vector.cwiseAbs().maxCoeff()) <= limit,
          std::string(what) + ": a value is outside +-" + std::to_string(limit));
  return vector;
}

std::optional<double> importValue(const std::optional<double>& value, double most,
                                  const char* what) {
  if (value) requireRange(*value, 0.0, most, what);
  return value;
}

std::optional<double> importMass(const std::optional<double>& mass_kg) {
  if (mass_kg) requireRange(*mass_kg, limits::kMinMass_kg, limits::kMass_kg, "mass_kg");
  return mass_kg;
}

Motion importMotion(const Object& from) {
  Motion to;
  to.position_mm = requireLength(from.position_mm, limits::kPosition_mm, "position_mm");
  to.velocity_mm_s = requireLength(from.velocity_mm_s, limits::kVelocity_mm_s, "velocity_mm_s");
  to.acceleration_mm_s2 =
      requireLength(from.acceleration_mm_s2, limits::kAcceleration_mm_s2, "acceleration_mm_s2");
  to.angle_rad = requireRange(from.angle_rad, -limits::kAngle_rad, limits::kAngle_rad, "angle_rad");
  to.angular_velocity_rad_s =
      requireRange(from.angular_velocity_rad_s, -limits::kAngularVelocity_rad_s,
                   limits::kAngularVelocity_rad_s, "angular_velocity_rad_s");
  to.quality = requireRange(from.quality, 0.0, 1.0, "quality");
  to.visible_fraction = requireRange(from.visible_fraction, 0.0, 1.0, "visible_fraction");
  return to;
}

/// Returns the heights as a relief. Heights outside the mask become 0. Throws
/// std::invalid_argument.
Relief importHeights(const HeightMap& from, const Workspace& workspace) {
  const PixelRect rect{from.left_px, from.top_px, from.width_px, from.height_px};
  require(
      !rect.empty() && rect.u >= 0 && rect.v >= 0 && rect.width <= workspace.width_px - rect.u &&
          rect.height <= workspace.height_px - rect.v,
      "heights: the rectangle " + std::to_string(rect.width) + " x " + std::to_string(rect.height) +
          " px at (" + std::to_string(rect.u) + ", " + std::to_string(rect.v) +
          ") is not inside the picture of " + std::to_string(workspace.width_px) + " x " +
          std::to_string(workspace.height_px) + " px");
  require(from.height_mm.size() == rect.pixels() && from.mask.size() == rect.pixels(),
          "heights: height_mm has " + std::to_string(from.height_mm.size()) + " and mask has " +
              std::to_string(from.mask.size()) + " values, the rectangle has " +
              std::to_string(rect.pixels()) + " pixels");
  Relief to = Relief::blank(rect);
  const auto most_mm = static_cast<float>(workspace.depth_mm);
  for (std::size_t i = 0; i < rect.pixels(); ++i) {
    if (from.mask[i] == 0) continue;
    const float height_mm = from.height_mm[i];
    // The decoder of heights permits the same rounding.
    require(height_mm >= limits::kLowestHeight_mm && height_mm <= most_mm + 1.0F,
            "heights: " + std::to_string(height_mm) + " mm is outside 0.." +
                std::to_string(most_mm) + " mm");
    to.mask[i] = 1;
    to.height_mm[i] = std::clamp(height_mm, 0.0F, most_mm);
  }
  return to;
}

std::shared_ptr<const MotionGrid> importCells(const Object& object) {
  if (object.cells == nullptr) return nullptr;
  const Object::CellMotion& from = *object.cells;
  require(object.heights != nullptr && from.columns == gridCells(object.heights->width_px) &&
              from.rows == gridCells(object.heights->height_px),
          "cells: they have to cover the rectangle of the heights in squares of 16 px");
  const auto count = static_cast<std::size_t>(from.columns) * static_cast<std::size_t>(from.rows);
  require(from.velocity_mm_s.size() == count && from.acceleration_mm_s2.size() == count,
          "cells: each cell needs a velocity and an acceleration");
  for (const auto& each : from.velocity_mm_s)
    (void)requireLength(each, limits::kVelocity_mm_s, "cells: velocity_mm_s");
  for (const auto& each : from.acceleration_mm_s2)
    (void)requireLength(each, limits::kAcceleration_mm_s2, "cells: acceleration_mm_s2");
  return std::make_shared<const MotionGrid>(
      MotionGrid{from.columns, from.rows, from.velocity_mm_s, from.acceleration_mm_s2});
}

std::vector<Impact> importImpacts(const std::vector<Object::Impact>& from) {
  require(from.size() <= kMaxImpacts, "impacts: an object has at most 4 in a frame");
  std::vector<Impact> to;
  to.reserve(from.size());
  for (const Object::Impact& each : from) {
    to.push_back({importTime(each.time_s, "impact: time_s"),
                  requireLength(each.delta_velocity_mm_s, limits::kVelocity_mm_s,
                                "impact: delta_velocity_mm_s")});
  }
  return to;
}

/// Converts an object, except its heights.
HapticObject importObject(const Object& from) {
  require(from.layer < kMaxObjects, "layer: " + std::to_string(from.layer) + " is outside 0..15");
  HapticObject to;
  to.id = from.id;
  to.layer = from.layer;
  to.motion = importMotion(from);
  to.grid = importCells(from);
  to.impacts = importImpacts(from.impacts);
  to.material = importMaterial(from.material);
  return to;
}

}  // namespace

Material importMaterial(const Object::Material& from) {
  return {importValue(from.stiffness_N_mm, limits::kStiffness_N_mm, "stiffness_N_mm"),
          importValue(from.damping_Ns_m, limits::kDamping_Ns_m, "damping_Ns_m"),
          importValue(from.static_friction, limits::kFriction, "static_friction"),
          importValue(from.dynamic_friction, limits::kFriction, "dynamic_friction"),
          importValue(from.texture_K_mm, limits::kWorkspace_mm, "texture_K_mm"),
          importMass(from.mass_kg)};
}

StreamDescription importInfo(const StreamInfo& info) {
  require(info.name.size() <= limits::kStreamName, "name: more than 256 bytes");
  require(sanitizeUtf8(info.name) == info.name,
          "name: " + quote(info.name) + " is not UTF-8, or has characters that cannot be seen");
  require(info.width_px >= 1 && info.width_px <= kMaxWidth_px && info.height_px >= 1 &&
              info.height_px <= kMaxHeight_px,
          "size: " + std::to_string(info.width_px) + " x " + std::to_string(info.height_px) +
              " px is outside 1 x 1 .. 1920 x 1080 px");
  StreamDescription to;
  to.name = info.name;
  to.fps = requireRange(info.fps, limits::kMinFps, limits::kMaxFps, "fps");
  const auto side = [](double size_mm, const char* what) {
    return requireRange(size_mm, 1e-3, limits::kWorkspace_mm, what);
  };
  to.workspace = {info.width_px,
                  info.height_px,
                  side(info.width_mm, "width_mm"),
                  side(info.height_mm, "height_mm"),
                  side(info.depth_mm, "depth_mm"),
                  info.stretch};
  to.method = info.thesis ? Method::kThesis : Method::kHapticast;
  to.pipeline_latency =
      fromSeconds(requireRange(info.latency_s, 0.0, 1e-9 * limits::kLatency_ns, "latency_s"));
  to.largest_acceleration_mm_s2 = requireRange(
      info.max_acceleration_mm_s2, 0.0, limits::kAcceleration_mm_s2, "max_acceleration_mm_s2");
  to.mass_kg = importMass(info.mass_kg);
  return to;
}

HapticFrame FrameImporter::import(const Frame& frame, std::uint64_t id) {
  return import(frame, id, importTime(frame.time_s, "time_s"));
}

HapticFrame FrameImporter::import(const Frame& frame, std::uint64_t id, MediaTime media_time) {
  require(frame.objects.size() <= kMaxObjects, "objects: a frame has at most 16");
  HapticFrame to;
  to.epoch = frame.epoch;
  to.id = id;
  to.media_time = media_time;
  std::map<ObjectKey, Known> known;
  std::size_t pixels = 0;
  for (const Object& object : frame.objects) {
    HapticObject& made = to.objects.emplace_back(importObject(object));
    // The time of the frame may be another one here. Its impacts keep their distance.
    if (!made.impacts.empty()) {
      const Duration shift = media_time - importTime(frame.time_s, "time_s");
      for (Impact& impact : made.impacts) impact.time += shift;
    }
    const auto [place, is_new] = known.try_emplace(makeKey(made));
    require(is_new, "objects: two objects have the id " + std::to_string(object.id) +
                        " and the layer " + std::to_string(object.layer));
    if (object.heights == nullptr) continue;
    const auto before = known_.find(makeKey(made));
    if (before != known_.end() && before->second.from == object.heights) {
      place->second = before->second;
    } else {
      place->second = {
          object.heights,
          std::make_shared<const Relief>(importHeights(*object.heights, description_.workspace)),
          id};
    }
    made.relief = place->second.relief;
    made.changed_in_frame = place->second.changed_in_frame;
    pixels += made.relief->rect.pixels();
  }
  require(pixels <= kMaxReliefPixels, "objects: their heights have more than 4,147,200 pixels");
  known_ = std::move(known);
  return to;
}

}  // namespace hapticast
