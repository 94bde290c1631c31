// SPDX-License-Identifier: MIT
#include "client/haptics/dynamic_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/playback/pose.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {

constexpr double kFullWeight_mm = 0.2;  // full weight of the dynamic force from this penetration on
constexpr double kMassRatio = 10.0;     // lower bound of m_object, in m_cursor
// Mass without an author's value. Chosen: an object that fits into a hand. With a heavier mass the
// errors of a slow clip would fill the force, because its largest acceleration is hardly more than
// noise.
constexpr double kUnknownMass_kg = 0.5;
// Chosen: above the mass that a hand usually moves (ISO 11228-1 covers lifting from 3 kg on). The
// frames of a stream support an acceleration but no mass. With a tonne, the last micrometre of them
// would reach the device's peak.
constexpr double kHeaviest_kg = 5.0;
constexpr double kShortestPulse_s = 0.015;
// Chosen: the rest of the slew limit remains for the surface.
constexpr double kPulseSlew = 0.8;
// Two times that differ by less belong to the same impact. An impact that the first frame lists
// later than this has no pulse.
constexpr double kSameImpact_s = 0.015;
constexpr double kKnee = 0.8;  // share of the pulse limit
// Chosen: half of the peak remains for the surface, whatever acceleration a stream states.
constexpr double kObjectShare = 0.5;
// Chosen: force allowed beyond the plausibility bounds, because noise at rest is no lie.
constexpr double kSlack_N = 0.15;
// A smaller reduction is not reported. One count at 0.5 N/mm has this size.
constexpr double kFelt_N = 0.03;

/// Returns device metres per nominal millimetre: beta of Eq. 6.
double metresPerMillimetre(double scale) noexcept { return scale * 1e-3; }

/// Bilinear interpolation between the centres of the cells, constant beyond the outer centres.
/// Requires frame.grid.
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

/// Acceleration of the object's material at the contact, nominal mm/s²: as stated by the stream,
/// and within the plausibility bounds.
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
          limitLength(object.acceleration_mm_s2, plausibility.acceleration_mm_s2) +
              limitLength(grid, plausibility.grid_mm_s2) +
              turned(std::clamp(turn, -plausibility.turn_rad_s, plausibility.turn_rad_s),
                     std::clamp(turn_rate, -plausibility.turn_rate_rad_s2,
                                plausibility.turn_rate_rad_s2))};
}

bool isUnderWay(const Impact& impact, MediaTime play_time) noexcept {
  const double since_s = secondsBetween(impact.time, play_time);
  return since_s >= 0.0 && since_s < kSameImpact_s;
}

/// Returns the first active impact that differs from `known` (null: differs from none); null if
/// there is none.
const Impact* impactUnderWay(const PlayObject& object, MediaTime play_time,
                             const Impact* known) noexcept {
  for (std::size_t i = 0; i < std::min(object.impact_count, kMaxImpacts); ++i) {
    const Impact& impact = object.impacts[i];
    if (!isUnderWay(impact, play_time)) continue;
    if (known != nullptr && std::abs(secondsBetween(known->time, impact.time)) < kSameImpact_s)
      continue;
    return &impact;
  }
  return nullptr;
}

/// Soft-knee compressor: identity up to a knee, so that the impulse of a weak impact is exact;
/// above the knee the result approaches the limit smoothly.
double compressForce(double height_N, double limit_N) noexcept {
  if (!(limit_N > 0.0)) return 0.0;
  const double knee_N = kKnee * limit_N;
  if (height_N <= knee_N) return height_N;
  const double above = (height_N - knee_N) / (limit_N - knee_N);
  return knee_N + (limit_N - knee_N) * (1.0 - 1.0 / (1.0 + above));
}

}  // namespace

DynamicForce::DynamicForce(const DeviceProfile& profile) noexcept : profile_(profile) {}

double DynamicForce::cursorMass_kg() const noexcept {
  // -m_cursor a_cursor is virtual inertia. With at most the device's own mass it keeps a stability
  // margin of three, at estimator delays of up to two ticks (measured, client/haptics/README.md).
  return std::clamp(profile_.mass_kg, 0.0, kCursorMass_kg);
}

double DynamicForce::objectMass_kg(const Material& material, const StreamTiming& stream,
                                   double scale) const noexcept {
  const double authored_kg =
      own_mass_kg_.value_or(material.mass_kg.value_or(stream.author_mass_kg));
  const bool authored = authored_kg > 0.0 && std::isfinite(authored_kg);
  const double wanted_kg =
      std::max(authored ? std::min(authored_kg, kHeaviest_kg) : kUnknownMass_kg,
               kMassRatio * cursorMass_kg());
  const double largest_m_s2 = stream.largest_acceleration_mm_s2 * metresPerMillimetre(scale);
  if (!(largest_m_s2 > 0.0) || !std::isfinite(largest_m_s2)) return wanted_kg;
  // The bound is the continuous force: an object may accelerate for a whole clip, and noise never
  // rests. The rest up to the peak remains for the surface and for impacts.
  return std::min(wanted_kg, profile_.continuous_N / largest_m_s2);
}

/// Starts the pulse of `impact` at `play_time`, its first tick: a half-sine. One of the height A
/// and the length T has the area 2 A T / pi = m |dv|, and rises by A pi / T at most. T is the
/// shortest length whose rise fits into the slew limit.
void DynamicForce::startPulse(const Impact& impact, const InterpolatedObject& object,
                              MediaTime play_time, double kg_m_per_mm) noexcept {
  const double slew_N_s = kPulseSlew * profile_.slew_rise_N_per_tick / kTick_s;
  const double limit_N = profile_.pulse_limit_N;
  const double longest_s = std::max(kShortestPulse_s, std::numbers::pi * limit_N / slew_N_s);
  const auto pulseOf = [&](const Vec3& change_mm_s) noexcept {
    const double impulse_N_s = kg_m_per_mm * change_mm_s.norm();
    const double length_s = std::clamp(std::numbers::pi * std::sqrt(impulse_N_s / (2.0 * slew_N_s)),
                                       kShortestPulse_s, longest_s);
    return std::pair(length_s,
                     compressForce(impulse_N_s * std::numbers::pi / (2.0 * length_s), limit_N));
  };
  const Vec3 change_mm_s = limitLength(impact.delta_velocity_mm_s, object.plausibility.impact_mm_s);
  const auto [length_s, height_N] = pulseOf(change_mm_s);
  pulse_ = {.impact = impact, .begin = play_time, .length_s = length_s};
  pulse_.object = object.before->id;
  const double size_mm_s = change_mm_s.norm();
  if (size_mm_s > 0.0 && std::isfinite(size_mm_s))
    pulse_.height_N = height_N / size_mm_s * change_mm_s;
  const double cut_N = pulseOf(impact.delta_velocity_mm_s).second - height_N;
  pulse_.implausible = !(cut_N <= kFelt_N);
  has_pulse_ = true;
}

bool DynamicForce::pulseActs(MediaTime play_time) const noexcept {
  const double since_s = secondsBetween(pulse_.begin, play_time);
  return has_pulse_ && since_s >= 0.0 && since_s < pulse_.length_s;
}

Vec3 DynamicForce::pulse_N(const InterpolatedObject& object, MediaTime play_time,
                           double kg_m_per_mm) noexcept {
  const PlayObject& before = *object.before;
  const bool known = has_pulse_ && pulse_.object == before.id;
  if (!known || !pulseActs(play_time)) {
    const Impact* const last = known ? &pulse_.impact : nullptr;
    const Impact* impact = impactUnderWay(before, play_time, last);
    if (impact == nullptr && object.after != nullptr)
      impact = impactUnderWay(*object.after, play_time, last);
    if (impact == nullptr) return Vec3::Zero();
    startPulse(*impact, object, play_time, kg_m_per_mm);
  }
  const double phase = std::numbers::pi * secondsBetween(pulse_.begin, play_time) / pulse_.length_s;
  return std::sin(phase) * pulse_.height_N;
}

Vec3 DynamicForce::evaluate(const InterpolatedObject* object, double penetration_mm,
                            const Vec3& cursor_acceleration_m_s2, MediaTime play_time,
                            const StreamTiming& stream, double scale,
                            const Vec3* contact_mm) noexcept {
  inertia_N_.setZero();
  implausible_ = false;
  if (object == nullptr || !(penetration_mm > 0.0)) return Vec3::Zero();
  const double to_metres = metresPerMillimetre(scale);
  const double mass_kg = objectMass_kg(object->before->material, stream, scale);
  const AtContact acceleration = computeAcceleration(
      *object, contact_mm != nullptr ? *contact_mm : object->position_mm, stream.workspace);
  const auto pushes_N = [&](const Vec3& acceleration_mm_s2) noexcept {
    return limitLength(mass_kg * to_metres * acceleration_mm_s2, kObjectShare * profile_.peak_N);
  };
  const Vec3 streamed_N = pushes_N(acceleration.streamed);
  const Vec3 plausible_N = pushes_N(acceleration.plausible);
  const Vec3 object_N = plausible_N + limitLength(streamed_N - plausible_N, kSlack_N);
  const Vec3 inertia_N = -cursorMass_kg() * cursor_acceleration_m_s2;
  const Vec3 pulsed_N = pulse_N(*object, play_time, mass_kg * to_metres);
  const Vec3 force_N = object_N + inertia_N + pulsed_N;
  implausible_ =
      (streamed_N - object_N).norm() > kFelt_N ||
      (pulse_.implausible && pulse_.object == object->before->id && pulseActs(play_time));
  if (!force_N.allFinite()) return Vec3::Zero();
  const double length_N = force_N.norm();
  const double share = std::min(1.0, penetration_mm / kFullWeight_mm) *
                       (length_N > profile_.peak_N ? profile_.peak_N / length_N : 1.0);
  inertia_N_ = share * inertia_N;
  return share * force_N;
}

}  // namespace hapticast::client
