// SPDX-License-Identifier: MIT
#include "tests/evaluate/touch/touch_player.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "client/haptics/contact/proxy_surface.hpp"
#include "client/haptics/safety/chain.hpp"
#include "client/net/inline_preparation.hpp"
#include "client/net/receiver.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::evaluate {

namespace {

using client::Contact;
using client::Interpolation;
using client::Scene;
using client::SceneInterpolator;
using client::SurfaceKind;

// Frames and ticks that fall together in decimal do so in spite of rounding.
constexpr double kInstant_s = 1e-8;
constexpr double kAllThere_s = -0.08;

// The receiver's side: whole frames into the pool when they are due.
class Viewer {
 public:
  Viewer(const Stream& stream, const Variant& variant)
      : stream_(stream),
        preparation_(pool_, clock_, variant.method,
                     [this](const client::PreparedFrame& frame) { receiver_.addPrepared(frame); }),
        receiver_(preparation_, state_, 2),
        lookup_(pool_, variant.interpolation) {
    receiver_.connected(stream.description, clock_.now());
  }

  // All frames up to this media time; whether there was one.
  bool deliver(double until_s) {
    const auto& frames = stream_.frames;
    const std::size_t first = next_;
    while (next_ < frames.size() && frames[next_].time_s <= until_s + kInstant_s) {
      const std::vector<std::uint8_t>& bytes = *frames[next_++].message;
      auto message = decode(bytes);
      if (!message.ok())
        throw std::runtime_error("a frame cannot be read: " + stream_.description.name);
      receiver_.frame(std::get<CodedFrame>(std::move(message.value())), clock_.now());
      (void)preparation_.step();
    }
    return next_ > first;
  }

  // Within an interval of frames in any order.
  void touch(const Touch& surface, Tick& tick, const Look& look) {
    const client::StreamTiming& stream = receiver_.stream();
    const Scene& scene = lookup_.at(mediaTime(tick.time_s + kInstant_s), stream);
    const Contact contact = surface(lookup_, scene, tick.hand.hip_mm, stream.workspace);
    tick.contact = contact.contact;
    tick.normal = contact.normal;
    if (contact.contact) tick.displacement_mm = contact.displacement_mm;
    if (look) look(scene, stream, contact, tick);
  }

 private:
  const Stream& stream_;
  const ManualClock clock_{localTime(0.0)};  // stands: a frame is ready when it comes
  client::FramePool pool_;
  LatestValue<client::StreamTiming> state_;
  client::InlinePreparation preparation_;
  client::Receiver receiver_;
  SceneInterpolator lookup_;
  std::size_t next_ = 0;
};

Touch surfaceModel(SurfaceKind kind) {
  return [kind](const SceneInterpolator&, const Scene& scene, const Vec3& hip_mm,
                const Workspace& workspace) {
    return client::findContact(kind, scene, hip_mm, workspace);
  };
}

// The proxies keep their state from tick to tick.
Touch proxy() {
  const double deepest_mm =
      client::armDepth_mm(client::DeviceProfile{}.stiffness_N_mm, client::DeviceProfile{}.peak_N);
  const auto state = std::make_shared<client::ProxySurface>();
  return [=](const SceneInterpolator&, const Scene& scene, const Vec3& hip_mm,
             const Workspace& workspace) {
    return state->computeContact(scene, hip_mm, workspace, deepest_mm);
  };
}

// Memoryless, by other samples or another K than the client's own.
using Sampler = std::function<client::SurfacePoint(const client::InterpolatedObject&, const Vec2&,
                                                   const Workspace&)>;
Touch memoryless(const Sampler& sampler,
                 const std::function<Vec3(double, const SurfaceSample&)>& law) {
  return [=](const SceneInterpolator&, const Scene& scene, const Vec3& hip_mm,
             const Workspace& workspace) {
    Contact deepest;
    for (std::size_t i = 0; i < scene.object_count; ++i) {
      const client::SurfacePoint point = sampler(scene.objects[i], hip_mm.head<2>(), workspace);
      const double depth_mm = point.sample.height_mm - hip_mm.z();
      if (!point.inside || !(depth_mm > deepest.depth_mm)) continue;
      deepest.contact = true;
      deepest.depth_mm = depth_mm;
      deepest.object = &scene.objects[i];
      deepest.displacement_mm = law(depth_mm, point.sample);
    }
    return deepest;
  };
}

Touch perturbed(double texture_K_mm) {
  return memoryless(client::evaluateSurface, [=](double depth_mm, const SurfaceSample& sample) {
    return client::perturbedDisplacement(depth_mm, std::max(0.0, sample.height_mm), sample.gradient,
                                         texture_K_mm, Workspace{}.depth_mm);
  });
}

// Input of the proxy for the tangent plane.
client::SurfacePoint splineAt(const client::InterpolatedObject& object, const Vec2& nominal_mm,
                              const Workspace& workspace) {
  client::SurfacePoint point;
  if (object.before->field == nullptr || object.before->field->empty()) return point;
  client::MovingRelief relief;
  relief.update(object, workspace);
  const Eigen::Rotation2Dd turn(object.angle_rad);
  const Vec2 q_mm = turn.inverse() * (nominal_mm - object.position_mm.head<2>());
  const client::BlendedHeight height = relief.now(relief.heights(q_mm));
  point.sample = {height.height_mm + object.position_mm.z(), turn * height.gradient};
  point.inside = relief.now(relief.edges(q_mm)).distance_mm > 0.0;
  return point;
}

Touch normalBySpline() {
  return memoryless(splineAt, [](double depth_mm, const SurfaceSample& sample) {
    return client::tangentPlane(depth_mm, sample.gradient).displacement_mm;
  });
}

Touch thesisInTime() {
  const auto state = std::make_shared<client::ThesisInterpolation>();
  return [state](const SceneInterpolator& lookup, const Scene& scene, const Vec3& hip_mm,
                 const Workspace& workspace) {
    return state->evaluate(lookup, scene.play_time, hip_mm, workspace);
  };
}

}  // namespace

std::vector<Variant> allVariants() {
  const auto normal = [] { return surfaceModel(SurfaceKind::kNormal); };
  std::vector<Variant> out{
      {"proxy", proxy, Interpolation::kHermite, Method::kHapticast, true, false},
      {"proxy, linear in time", proxy, Interpolation::kLinear},
      {"proxy, held in time", proxy, Interpolation::kHold},
      {"normal", normal},
      {"normal, B-spline", normalBySpline},
      {"perturbed, K 0", [] { return perturbed(0.0); }},
      {"perturbed, K 1", [] { return perturbed(1.0); }},
      {"perturbed, K 30", [] { return perturbed(30.0); }},
      {"cubic of forces", thesisInTime},
      {"thesis", thesisInTime, Interpolation::kHermite, Method::kThesis, false, true}};
  return out;
}

const Variant& defaultVariant() {
  static const Variant variant = allVariants().front();
  return variant;
}

const Variant& thesisVariant() {
  static const Variant variant = allVariants().back();
  return variant;
}

namespace {

// One after the other over the ticks between two frames: memory is warm for all alike.
std::vector<ForceTrace> renderTogether(const Stream& stream,
                                       const std::vector<const Variant*>& variants,
                                       const Hand& hand, const PlayTimes& times, const Look& look) {
  Viewer viewer(stream, *variants.front());
  std::vector<Touch> touches;
  touches.reserve(variants.size());
  for (const Variant* variant : variants) touches.push_back(variant->make());
  std::vector<ForceTrace> out(variants.size());
  const double last_s = stream.frames[stream.frames.size() - 2].time_s;
  const auto last_tick = static_cast<std::int64_t>(std::min(times.to_s, last_s) * 1e3);
  const auto per_frame = static_cast<std::int64_t>(1e3 / stream.description.fps);
  for (auto tick = static_cast<std::int64_t>(std::ceil(times.from_s * 1e3)); tick < last_tick;) {
    // Nothing comes between frames but where they are late.
    const std::int64_t whole = (tick / per_frame + 1) * per_frame;
    const std::int64_t next = std::min(last_tick, times.arrival_s > kAllThere_s ? tick + 1 : whole);
    const bool came = viewer.deliver(1e-3 * double(tick) - times.arrival_s);
    std::vector<Tick> ticks;
    for (std::int64_t i = tick; i < next; ++i) {
      const double time_s = 1e-3 * double(i);
      const bool new_frame = i % per_frame == 0 || (i == tick && came);
      ticks.push_back({time_s, hand(time_s), Vec3::Zero(), Vec3::UnitZ(), false, new_frame});
    }
    for (std::size_t k = 0; k < touches.size(); ++k) {
      std::vector<Tick>& trace = out[k].ticks;
      const std::size_t begin = trace.size();
      trace.insert(trace.end(), ticks.begin(), ticks.end());
      const double start_us = threadTime_us();
      for (std::size_t i = begin; i < trace.size(); ++i) viewer.touch(touches[k], trace[i], look);
      out[k].tick_us += threadTime_us() - start_us;
    }
    tick = next;
  }
  for (ForceTrace& trace : out) trace.tick_us /= std::max(1.0, double(trace.ticks.size()));
  return out;
}

}  // namespace

std::vector<ForceTrace> renderTraces(const std::function<const Stream&(Method)>& streams,
                                     const std::vector<Variant>& variants, const Hand& hand,
                                     const PlayTimes& times) {
  std::map<std::pair<Method, Interpolation>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < variants.size(); ++i)
    groups[{variants[i].method, variants[i].interpolation}].push_back(i);
  std::vector<ForceTrace> out(variants.size());
  for (const auto& [kind, indices] : groups) {
    std::vector<const Variant*> together;
    for (const std::size_t i : indices) together.push_back(&variants[i]);
    std::vector<ForceTrace> trace =
        renderTogether(streams(kind.first), together, hand, times, nullptr);
    for (std::size_t k = 0; k < indices.size(); ++k) out[indices[k]] = std::move(trace[k]);
  }
  return out;
}

ForceTrace renderTrace(const Stream& stream, const Variant& variant, const Hand& hand,
                       const PlayTimes& times, const Look& look) {
  return renderTogether(stream, {&variant}, hand, times, look).front();
}

double relativeError(const std::vector<Tick>& ticks) {
  double error = 0;
  double truth = 0;
  for (const Tick& tick : ticks) {
    if (!tick.trulyTouches()) continue;
    error += tick.error_mm().squaredNorm();
    truth += tick.hand.truth_mm.squaredNorm();
  }
  return truth > 0 ? std::sqrt(error / truth) : 0.0;
}

}  // namespace hapticast::evaluate
