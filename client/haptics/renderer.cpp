// SPDX-License-Identifier: MIT
#include "client/haptics/renderer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {
// After this many ticks without a reading the last position is void. Chosen: the longest gap that
// HipEstimator bridges.
constexpr int kSilentTicks = 20;
// Limit of an author's stiffness without --stiffness-limit, in the profile's stiffness. Chosen.
constexpr double kStiffnessShare = 3.0;

/// Moves a point of the frame `before` (nominal mm) with the object to play time.
Vec2 carryPoint(const InterpolatedObject& object, const Vec2& point_mm) noexcept {
  const Motion& then = object.before->motion;
  const Eigen::Rotation2Dd turn(object.angle_rad - then.angle_rad);
  return object.position_mm.head<2>() + turn * Vec2(point_mm - then.position_mm.head<2>());
}

Vec2 computeCentre(const InterpolatedObject& object, const Workspace& workspace) noexcept {
  return carryPoint(object, workspace.toNominal(object.before->field->deepestPoint_px()));
}

/// Returns the height of the surface at the centre; blended between two frames.
double centreHeight_mm(const InterpolatedObject& object) noexcept {
  const auto above = [](const PlayObject& frame) noexcept {
    return frame.field->deepestPointHeight_mm() - frame.motion.position_mm.z();
  };
  const double before_mm = above(*object.before);
  const bool blended = shows(object.after);
  const double change_mm = blended ? object.blend * (above(*object.after) - before_mm) : 0.0;
  return object.position_mm.z() + before_mm + change_mm;
}

const InterpolatedObject* findNearestObject(const Scene& scene, const Vec3& hip_mm,
                                            const Workspace& workspace) noexcept {
  const InterpolatedObject* nearest = nullptr;
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.object_count; ++i) {
    const InterpolatedObject& object = scene.objects[i];
    if (!shows(object.before)) continue;
    const double distance_mm = (computeCentre(object, workspace) - hip_mm.head<2>()).norm();
    if (distance_mm >= nearest_mm) continue;
    nearest_mm = distance_mm;
    nearest = &object;
  }
  return nearest;
}

bool isResting(Lookup kind) noexcept { return kind == Lookup::kHeld || kind == Lookup::kStale; }

void parseDevice(const DeviceProfile& profile, const DeviceState& state,
                 TickReport& report) noexcept {
  report.inputs.reading = state;
  report.device = state.status;
  report.buttons = state.status == DeviceStatus::kLost ? 0 : state.buttons;
  if (state.status == DeviceStatus::kOk) report.enabled = enabled(profile, state);
}

bool isFresh(Lookup kind) noexcept {
  return kind == Lookup::kInterpolated || kind == Lookup::kExtrapolated || kind == Lookup::kHeld;
}
}  // namespace

HapticRenderer::HapticRenderer(const RendererSettings& settings, FramePool& pool,
                               LatestValue<StreamTiming>& stream, LatestValue<UserControls>& user,
                               Log* log) noexcept
    : settings_(settings),
      stream_(stream),
      user_(user),
      log_(log),
      motion_(settings.profile),
      lookup_(pool, settings.interpolation),
      dynamic_(settings.profile),
      force_mix_(settings.method, settings.surface),
      safety_(settings.profile),
      mapping_(DeviceMapping::fit(workspace_, settings.profile.workspace_mm)) {
  if (settings.unconfirmed) safety_.awaitConfirmation();
  report_.enabled = !settings.profile.enable_button;  // until the first reading
}

const TickReport& HapticRenderer::tick(LocalTime now, const DeviceState& state) noexcept {
  const StreamTiming& stream = stream_.load();
  const UserControls& user = user_.load();
  const Changes changes = updateInputs(stream, user);
  motion_.setDelay(safety_.delayTicks());
  motion_.sent(report_.force_N, safety_.wall_N_mm());
  const HipEstimate& hip = motion_.update(state);
  const MediaTime play_time = playout_.advance(now, stream, safety_.acts(), user);
  // The contact needs surface and HIP at one instant: the scene is evaluated where the HIP will be.
  const Scene& scene = lookup_.at(play_time + motion_.lookahead(), stream, user);

  report_.hip_mm = mapping_.toNominal(hip.position_mm);
  parseDevice(settings_.profile, state, report_);
  const bool restarts = changes.any() || hip.restarted;
  if (restarts) proxies_.restart();
  const Vec3 ahead_mm = report_.ahead_mm = mapping_.toNominal(hip.ahead.position_mm);
  const Contact contact = computeContact(scene, ahead_mm);
  SafetyInput input = safetyInput(hip, contact, scene);
  input.scene_jumped = changes.by_stream || scene.jumped || (contact.jump && !restarts);
  input.world_jumped = changes.any() || input.scene_jumped || contact.jump;
  input.device_lost = state.status == DeviceStatus::kLost;
  const Vec3 contact_mm = report_.contact_mm = ahead_mm + contact.displacement_mm;
  if (!paused_) {
    input.dynamic_N = dynamic_.evaluate(contact.object, contact.depth_mm, hip.acceleration_m_s2,
                                        scene.play_time, stream, mapping_.scale, &contact_mm);
    input.inertia_N = dynamic_.inertia_N();
    input.implausible = dynamic_.implausible();
  }
  updateMaterial(input);
  const SafetyOutput out = safety_.step(input);

  reportTick(now, play_time, scene, out);
  if (out.contact && isSoftened(contact.object)) {
    report_.safety_actions |= bit(SafetyAction::kStiffness);
  }
  report_.fault = classifyFault(out, hip, input.device_lost);
  reportObject(contact, scene);
  recordTick();
  return report_;
}

void HapticRenderer::reportTick(LocalTime now, MediaTime play_time, const Scene& scene,
                                const SafetyOutput& out) noexcept {
  ++report_.tick;
  report_.time = now;
  report_.inputs.frames = lookup_.framesTaken();
  report_.play_time = play_time;
  scene_time_ = scene.play_time;
  report_.playout_delay = playout_.delay();
  report_.force_N = out.force_N;
  report_.static_force_N = out.static_force_N;
  report_.dynamic_force_N = out.dynamic_force_N;
  report_.penetration_mm = out.penetration_mm / mapping_.scale;
  report_.contact = out.contact;
  report_.lookup = scene.kind;
  report_.halt = safety_.halt();
  report_.trust_loss_cause = safety_.findDistrusted();
  report_.trust_score_ticks = safety_.trustScore();
  report_.step_excess_N = out.step_excess_N;
  report_.safety_actions = out.safety_actions;
  report_.work = safety_.work();
  report_.safety_states = states_.update(now, report_.work.user_mJ(), report_.halt, acknowledged_);
  report_.mapping = mapping_;
}

/// Applies changes of stream and controls. Returns the changes after which the scene has no
/// connection with the last tick.
HapticRenderer::Changes HapticRenderer::updateInputs(const StreamTiming& stream,
                                                     const UserControls& user) noexcept {
  Changes changes;
  report_.inputs.timing = stream.number;
  report_.inputs.controls = user.number;
  changes.by_stream = stream.connected != connected_ && stream.connected;
  if (changes.by_stream) safety_.newConnection();
  changes.by_user = force_mix_.update(user);
  proxies_.setFriction(force_mix_.friction());
  dynamic_.replaceMass(force_mix_.mass_kg());
  connected_ = stream.connected;
  if (paused_ && !user.paused) {  // the stream continued meanwhile: join it like a new one
    playout_.resync();
    lookup_.resync();
    changes.by_user = true;
  }
  if (user.paused && !paused_ && force_mix_.method() == Method::kThesis) changes.by_user = true;
  paused_ = user.paused;
  if (!(stream.workspace == workspace_)) {
    workspace_ = stream.workspace;
    mapping_ = DeviceMapping::fit(workspace_, settings_.profile.workspace_mm);
    changes.by_stream = true;
  }
  acknowledged_ = std::exchange(rearmed_, user.rearm) != user.rearm;
  const bool by_itself =
      std::exchange(rearmed_by_itself_, user.rearm_by_itself) != user.rearm_by_itself;
  if (acknowledged_ || by_itself) safety_.rearm();
  if (std::exchange(stopped_, user.stop) != user.stop) safety_.stop();  // after it: a stop wins
  return changes;
}

Contact HapticRenderer::computeContact(const Scene& scene, const Vec3& hip_mm) noexcept {
  if (force_mix_.method() == Method::kThesis) {
    // The thesis's method needs the next frame, and none arrives while play time is paused.
    return paused_ ? findContact(SurfaceKind::kPerturbed, scene, hip_mm, workspace_)
                   : thesis_.evaluate(lookup_, scene.play_time, hip_mm, workspace_);
  }
  if (force_mix_.surface() == SurfaceKind::kProxy) {
    return proxies_.computeContact(scene, hip_mm, workspace_, deepest_mm(scene));
  }
  return findContact(force_mix_.surface(), scene, hip_mm, workspace_);
}

/// Converts from nominal to device: the scale of the mapping for lengths and speeds; directions are
/// unchanged.
SafetyInput HapticRenderer::safetyInput(const HipEstimate& hip, const Contact& contact,
                                        const Scene& scene) const noexcept {
  SafetyInput input;
  input.position_mm = hip.finite ? hip.position_mm : Vec3::Constant(std::nan(""));
  input.velocity_mm_s = hip.velocity_mm_s;
  input.ahead = hip.ahead;
  input.measurement_jumped = hip.restarted;
  input.measurement_late = hip.late;
  input.contact = contact.contact;
  input.displacement_mm = contact.displacement_mm * mapping_.scale;
  input.normal = contact.normal;
  if (!paused_ && !isResting(scene.kind)) {
    input.surface_velocity_mm_s = contact.surface_velocity_mm_s * mapping_.scale;
  }
  input.stiffness_factor = contact.stiffness_factor;
  input.stiffness_N_mm = stiffness_N_mm(contact.object);
  if (contact.object != nullptr) {
    input.damping_Ns_m =
        contact.object->before->material.damping_Ns_m.value_or(kDefaultDamping_Ns_m);
  }
  input.scene_step_s = secondsBetween(scene_time_, scene.play_time);
  input.in_contact =
      connected_ && report_.enabled && isFresh(scene.kind) && hip.ticks_without_data < kSilentTicks;
  input.dynamic_valid = scene.kind == Lookup::kInterpolated && !paused_;
  return input;
}

double HapticRenderer::stiffness_N_mm(const InterpolatedObject* object) const noexcept {
  if (settings_.stiffness_N_mm > 0.0) return settings_.stiffness_N_mm;
  const double usual_N_mm = settings_.profile.stiffness_N_mm;
  if (object == nullptr) return usual_N_mm;
  const double limit_N_mm = stiffnessLimit_N_mm();
  const double requested_N_mm = object->before->material.stiffness_N_mm.value_or(usual_N_mm);
  // The safety chain rejects NaN.
  return requested_N_mm > limit_N_mm ? limit_N_mm : requested_N_mm;
}

double HapticRenderer::stiffnessLimit_N_mm() const noexcept {
  return settings_.stiffness_limit_N_mm > 0.0 ? settings_.stiffness_limit_N_mm
                                              : kStiffnessShare * settings_.profile.stiffness_N_mm;
}

/// Returns true if the stiffness of the author exceeds the user's limit.
bool HapticRenderer::isSoftened(const InterpolatedObject* object) const noexcept {
  return object != nullptr && settings_.stiffness_N_mm == 0.0 &&
         object->before->material.stiffness_N_mm.value_or(0.0) > stiffness_N_mm(object);
}

/// Limits the rate of the material. After a jump the force begins at zero, with the present
/// material at once.
void HapticRenderer::updateMaterial(SafetyInput& input) noexcept {
  const bool in_contact = report_.contact && input.contact && !input.world_jumped;
  const double requested_N_mm = input.stiffness_N_mm * force_mix_.stiffness();
  const double most_N_mm = std::max(input.stiffness_N_mm, stiffnessLimit_N_mm());
  const double wall_N_mm = requested_N_mm > most_N_mm ? most_N_mm : requested_N_mm;
  input.stiffness_N_mm = stiffness_.step(wall_N_mm * force_mix_.staticGain(), in_contact);
  input.damping_Ns_m = damping_.step(input.damping_Ns_m * force_mix_.staticGain(), in_contact);
  const double dynamic = force_mix_.dynamicGain(in_contact);
  input.dynamic_N *= dynamic;
  input.inertia_N *= dynamic;
}

/// Returns the arming depth of the safety chain for the stiffest object of the scene, nominal mm.
double HapticRenderer::deepest_mm(const Scene& scene) const noexcept {
  double stiffest_N_mm = 0.0;
  for (std::size_t i = 0; i < scene.object_count; ++i) {
    stiffest_N_mm = std::max(stiffest_N_mm, stiffness_N_mm(&scene.objects[i]));
  }
  return armDepth_mm(stiffest_N_mm, settings_.profile.peak_N) / mapping_.scale;
}

void HapticRenderer::reportObject(const Contact& contact, const Scene& scene) noexcept {
  const InterpolatedObject* object = contact.object != nullptr
                                         ? contact.object
                                         : findNearestObject(scene, report_.hip_mm, workspace_);
  report_.object_present =
      object != nullptr && shows(object->before) && connected_ && isFresh(scene.kind);
  report_.over_object = false;
  report_.height_at_hip_mm = 0.0;
  if (!report_.object_present) return;
  report_.object_id = object->before->id;
  report_.object_position_mm = object->position_mm;
  report_.object_velocity_mm_s = object->velocity_mm_s;
  report_.object_centre_mm = computeCentre(*object, workspace_);
  report_.object_centre_height_mm = centreHeight_mm(*object);
  const SurfacePoint below = evaluateSurface(*object, report_.hip_mm.head<2>(), workspace_);
  report_.over_object = below.inside;
  if (below.inside) report_.height_at_hip_mm = below.sample.height_mm;
}

Fault HapticRenderer::classifyFault(const SafetyOutput& out, const HipEstimate& hip,
                                    bool device_lost) noexcept {
  if (out.latency_alarm) return Fault::kLatency;
  if (out.trust_lost) return Fault::kTrustLost;
  const Fault fault = device_lost                     ? Fault::kDeviceLost
                      : out.too_far                   ? Fault::kTooFar
                      : out.not_finite || !hip.finite ? Fault::kNotFinite
                                                      : Fault::kNone;
  const bool lasting = faulty_ && fault != Fault::kNone;
  faulty_ = fault != Fault::kNone;
  return lasting ? Fault::kNone : fault;
}

void HapticRenderer::recordTick() noexcept {
  recorder_.record(report_);
  if (log_ != nullptr && !log_->tryPush(report_)) ++dropped_reports_;
}

}  // namespace hapticast::client
