// SPDX-License-Identifier: MIT
#include "client/haptics/dynamic_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {

constexpr double kFullWeight_mm = 0.2;  // penetration at which the dynamic force acts in full
constexpr double kMassRatio = 10.0;     // m_object at least, in m_cursor
// What no author has weighed is taken for a thing that fits into a hand. A heavier one would make
// the errors of a slow clip, whose largest acceleration is hardly more than noise, fill the force.
constexpr double kUnknownMass_kg = 0.5;
// Chosen: more than a hand moves about by itself (ISO 11228-1 takes 3 kg and more for a load to be
// lifted). The stream's frames bear an acceleration out but no mass: a tonne would turn the last
// micrometre of them into all that the device can do.
constexpr double kHeaviest_kg = 5.0;
constexpr double kPulse_s = 0.015;
constexpr double kKnee = 0.8;  // of the pulse limit
// Chosen: whatever acceleration a stream announces, half of what the device can do is the
// surface's.
constexpr double kObjectShare = 0.5;
// Chosen: what the frames do not bear out may push by so much, since noise at rest is no lie, ...
constexpr double kSlack_N = 0.15;
// ... and what is cut of the force below this is no news; a count at 0.5 N/mm makes as much.
constexpr double kFelt_N = 0.03;

/// Device metres per nominal millimetre: beta of Eq. 6.
double metresPerMillimetre(double scale) noexcept { return scale * 1e-3; }

/// Bilinear between the centres of the cells, held beyond the outer ones. Requires frame.grid.
Vec3 gridAcceleration(const PlayObject& frame, const Vec2& image_px) noexcept {
  const MotionGrid* const grid = frame.grid;
  if (grid->columns <= 0 || grid->rows <= 0) return Vec3::Zero();
  const auto cells = static_cast<std::size_t>(grid->columns) * static_cast<std::size_t>(grid->rows);
  if (grid->acceleration_mm_s2.size() < cells || !image_px.allFinite()) return Vec3::Zero();
  const Vec2 last(grid->columns - 1, grid->rows - 1);
  const Vec2 corner(frame.grid_rect.u, frame.grid_rect.v);
  const Vec2 at = ((image_px - corner) / kGridCell_px - Vec2::Constant(0.5))
                      .cwiseMin(last)
                      .cwiseMax(Vec2::Zero());
  const auto i = static_cast<std::size_t>(at.x());
  const auto j = static_cast<std::size_t>(at.y());
  const double a = at.x() - static_cast<double>(i);
  const double b = at.y() - static_cast<double>(j);
  const auto columns = static_cast<std::size_t>(grid->columns);
  const std::size_t right = std::min(i + 1, columns - 1);
  const std::size_t down = std::min(j + 1, static_cast<std::size_t>(grid->rows) - 1);
  const auto cell = [&](std::size_t u, std::size_t v) -> Vec3 {
    return grid->acceleration_mm_s2[v * columns + u].cast<double>();
  };
  return (1.0 - b) * ((1.0 - a) * cell(i, j) + a * cell(right, j)) +
         b * ((1.0 - a) * cell(i, down) + a * cell(right, down));
}

Vec3 shortened(const Vec3& vector, double limit) noexcept {
  const double length = vector.norm();
  return length > limit ? Vec3(vector * (limit / length)) : vector;
}

/// Acceleration of the object's material at the contact, nominal mm/s².
struct AtContact {
  Vec3 streamed;
  Vec3 plausible;
};
AtContact computeAcceleration(const InterpolatedObject& object, const Vec3& contact_mm,
                              const Workspace& workspace) noexcept {
  Vec3 grid = Vec3::Zero();
  const auto addGrid = [&](const PlayObject& frame, double weight) noexcept {
    if (frame.grid == nullptr) return;
    const WarpedPoint at(frame, object, contact_mm.head<2>(), workspace, workspace.pixelsPerMm());
    grid += weight * gridAcceleration(frame, at.image_px);
  };
  const PlayObject& before = *object.before;
  double turn_rate = 0.0;
  if (object.after == nullptr) {
    addGrid(before, 1.0);
  } else {
    const PlayObject& after = *object.after;
    turn_rate = (after.motion.angular_velocity_rad_s - before.motion.angular_velocity_rad_s) *
                object.blend_rate_1_s;
    addGrid(before, 1.0 - object.blend);
    addGrid(after, object.blend);
  }
  const Vec2 r = (contact_mm - object.position_mm).head<2>();
  const auto turned = [&](double turn, double rate) noexcept {
    const Vec2 each = rate * Vec2(-r.y(), r.x()) - turn * turn * r;
    return Vec3(each.x(), each.y(), 0.0);
  };
  const PlausibilityBounds& plausibility = object.plausibility;
  const double turn = object.angular_velocity_rad_s;
  return {object.acceleration_mm_s2 + grid + turned(turn, turn_rate),
          shortened(object.acceleration_mm_s2, plausibility.acceleration_mm_s2) +
              shortened(grid, plausibility.grid_mm_s2) +
              turned(std::clamp(turn, -plausibility.turn_rad_s, plausibility.turn_rad_s),
                     std::clamp(turn_rate, -plausibility.turn_rate_rad_s2,
                                plausibility.turn_rate_rad_s2))};
}

double secondsSince(const Impact& impact, MediaTime play_time) noexcept {
  return secondsBetween(impact.time, play_time);
}

bool underWay(const Impact& impact, MediaTime play_time) noexcept {
  const double since_s = secondsSince(impact, play_time);
  return since_s >= 0.0 && since_s < kPulse_s;
}

/// The first impact under way that is not `known` (null: none is) over again.
const Impact* impactUnderWay(const PlayObject& object, MediaTime play_time,
                             const Impact* known) noexcept {
  for (std::size_t i = 0; i < std::min(object.impact_count, kMaxImpacts); ++i) {
    const Impact& impact = object.impacts[i];
    if (!underWay(impact, play_time)) continue;
    if (known != nullptr && std::abs(secondsBetween(known->time, impact.time)) < kPulse_s) continue;
    return &impact;
  }
  return nullptr;
}

/// As it is up to a knee, so that the impulse of what the device can render is exact; above it
/// smoothly under the limit.
double compressed(double height_N, double limit_N) noexcept {
  if (!(limit_N > 0.0)) return 0.0;
  const double knee_N = kKnee * limit_N;
  if (height_N <= knee_N) return height_N;
  const double above = (height_N - knee_N) / (limit_N - knee_N);
  return knee_N + (limit_N - knee_N) * (1.0 - 1.0 / (1.0 + above));
}

}  // namespace

DynamicForce::DynamicForce(const DeviceProfile& profile) noexcept : profile_(profile) {}

double DynamicForce::cursorMass_kg() const noexcept {
  // -m_cursor a_cursor is virtual inertia: with at most the device's own mass every estimator delay
  // up to two ticks keeps a margin of three (measured, README.md).
  return std::clamp(profile_.mass_kg, 0.0, kCursorMass_kg);
}

double DynamicForce::objectMass_kg(const StreamTiming& stream, double scale) const noexcept {
  const bool authored = stream.author_mass_kg > 0.0 && std::isfinite(stream.author_mass_kg);
  const double wanted_kg =
      std::max(authored ? std::min(stream.author_mass_kg, kHeaviest_kg) : kUnknownMass_kg,
               kMassRatio * cursorMass_kg());
  const double largest_m_s2 = stream.largest_acceleration_mm_s2 * metresPerMillimetre(scale);
  if (!(largest_m_s2 > 0.0) || !std::isfinite(largest_m_s2)) return wanted_kg;
  // The device's share is what it can hold for good: an object may accelerate for as long as a clip
  // lasts, and noise never rests. The rest, up to the peak, is left to the surface and to impacts.
  return std::min(wanted_kg, profile_.continuous_N / largest_m_s2);
}

Vec3 DynamicForce::pulse_N(const InterpolatedObject& object, MediaTime play_time,
                           double kg_m_per_mm) noexcept {
  // A half-sine of height A and length T has the area 2 A T / pi = m |dv|.
  const auto height_N = [&](const Vec3& change_mm_s) noexcept {
    return compressed(kg_m_per_mm * change_mm_s.norm() * std::numbers::pi / (2.0 * kPulse_s),
                      profile_.pulse_limit_N);
  };
  const PlayObject& before = *object.before;
  const Impact* const known = has_pulse_ && pulse_object_ == before.id ? &pulse_ : nullptr;
  if (known == nullptr || !underWay(*known, play_time)) {
    const Impact* impact = impactUnderWay(before, play_time, known);
    if (impact == nullptr && object.after != nullptr)
      impact = impactUnderWay(*object.after, play_time, known);
    if (impact == nullptr) return Vec3::Zero();
    has_pulse_ = true;
    pulse_ = *impact;
    pulse_.delta_velocity_mm_s =
        shortened(pulse_.delta_velocity_mm_s, object.plausibility.impact_mm_s);
    const double cut_N =
        height_N(impact->delta_velocity_mm_s) - height_N(pulse_.delta_velocity_mm_s);
    implausible_pulse_ = !(cut_N <= kFelt_N);
    pulse_object_ = before.id;
  }
  const double length = pulse_.delta_velocity_mm_s.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return Vec3::Zero();
  const double phase = std::numbers::pi * secondsSince(pulse_, play_time) / kPulse_s;
  return height_N(pulse_.delta_velocity_mm_s) * std::sin(phase) / length *
         pulse_.delta_velocity_mm_s;
}

Vec3 DynamicForce::evaluate(const InterpolatedObject* object, double penetration_mm,
                            const Vec3& cursor_acceleration_m_s2, MediaTime play_time,
                            const StreamTiming& stream, double scale,
                            const Vec3* contact_mm) noexcept {
  inertia_N_.setZero();
  implausible_ = false;
  if (object == nullptr || !(penetration_mm > 0.0)) return Vec3::Zero();
  const double to_metres = metresPerMillimetre(scale);
  const double mass_kg = objectMass_kg(stream, scale);
  const AtContact acceleration = computeAcceleration(
      *object, contact_mm != nullptr ? *contact_mm : object->position_mm, stream.workspace);
  const auto pushes_N = [&](const Vec3& acceleration_mm_s2) noexcept {
    return shortened(mass_kg * to_metres * acceleration_mm_s2, kObjectShare * profile_.peak_N);
  };
  const Vec3 streamed_N = pushes_N(acceleration.streamed);
  const Vec3 plausible_N = pushes_N(acceleration.plausible);
  const Vec3 object_N = plausible_N + shortened(streamed_N - plausible_N, kSlack_N);
  const Vec3 inertia_N = -cursorMass_kg() * cursor_acceleration_m_s2;
  const Vec3 pulsed_N = pulse_N(*object, play_time, mass_kg * to_metres);
  const Vec3 force_N = object_N + inertia_N + pulsed_N;
  implausible_ =
      (streamed_N - object_N).norm() > kFelt_N ||
      (implausible_pulse_ && pulse_object_ == object->before->id && underWay(pulse_, play_time));
  if (!force_N.allFinite()) return Vec3::Zero();
  const double length_N = force_N.norm();
  const double share = std::min(1.0, penetration_mm / kFullWeight_mm) *
                       (length_N > profile_.peak_N ? profile_.peak_N / length_N : 1.0);
  inertia_N_ = share * inertia_N;
  return share * force_N;
}

}  // namespace hapticast::client
