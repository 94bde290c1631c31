// SPDX-License-Identifier: MIT
// Extreme cases through the whole room: real frames in, force out, under a virtual clock.
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include "client/haptics/room.hpp"
#include "tests/evaluate/stability_cases.hpp"
#include "tests/evaluate/stability_parts.hpp"
#include "tests/unit/client/frame_builder.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

using Field = std::shared_ptr<const HeightField>;
constexpr PixelRect kPlate_px{288, 208, 64, 64};  // +-8 mm about the middle
constexpr double kPixel_mm = 0.25;
constexpr double kEvent_s = 2.5;
constexpr double kEnd_s = 5.0;
constexpr double kBegin_s = 1.0;

/// Made once, kept for both runs of a case.
class Reliefs {
 public:
  const HeightField* at(int shift_px, double height_mm, bool dome) {
    const auto key = std::make_tuple(shift_px, height_mm, dome);
    Field& field = reliefs_[key];
    if (field) return field.get();
    PixelRect rect = kPlate_px;
    rect.u += shift_px;
    const Vec2 centre(shift_px * kPixel_mm, 0.0);
    field = makeField(
        rect, Workspace{},
        [=](const Vec2& at) {
          return height_mm - (dome ? 0.02 * (at - centre).squaredNorm() : 0.0);
        },
        [](const Vec2&) { return true; });
    return field.get();
  }

 private:
  std::map<std::tuple<int, double, bool>, Field> reliefs_;
};

/// A room, a stream, a light hand; time t_s counts from the beginning, the event is at 0.
class Scene {
 public:
  Scene(bool naive, Reliefs& all) : reliefs(all), naive_(naive), settings_(settings()) {
    room = std::make_unique<Room>(settings_, pool, controls, reports, nullptr);
    device = std::make_unique<VirtualDevice>(settings_.profile, Hand::light(), clock, nullptr);
    control.connected = true;
    control.first_epoch = epoch;
    control.playout_delay_target = Duration(60'000'000);
  }
  static RoomSettings settings() {
    RoomSettings settings;
    settings.profile.friction_N = 0.05;
    return settings;
  }

  CaseOutcome run() {
    const DeviceMapping mapping = DeviceMapping::fit(Workspace{}, settings_.profile.workspace_mm);
    device->reset(mapping.toDevice(handAt(-kEvent_s)), Vec3::Zero());
    next_frame_s_ = kBegin_s;
    CaseOutcome out;
    double begin_mJ = 0.0;
    for (int tick = 0; tick < static_cast<int>((kEvent_s + kEnd_s) * 1e3); ++tick) {
      t_s = tick * 1e-3 - kEvent_s;
      if (at_tick) at_tick(*this);
      clock.advance(Duration(1'000'000));
      stream();
      controls.store(control);
      device->setTarget(mapping.toDevice(handAt(t_s)));
      step();
      if (tick == static_cast<int>(kEvent_s * 1e3) - 1) begin_mJ = work_mJ_;
      if (t_s < 0.0) continue;
      see(out, begin_mJ);
    }
    out.end_N = force_N_.norm();
    return out;
  }
  void add(PlayFrame& frame, const PlayObject& object) {
    frame.objects[frame.object_count++] = object;
  }
  void send(double media_s) {
    PlayFrame frame;
    frame.epoch = epoch;
    frame.id = ++id;
    frame.media_time = mediaTime(media_s);
    scene(frame, media_s - kBegin_s - kEvent_s);
    (void)client::send(pool, frame);
  }

  Reliefs& reliefs;
  FramePool pool;
  LatestValue<Controls> controls;
  LatestValue<TickReport> reports;
  std::unique_ptr<Room> room;
  std::unique_ptr<VirtualDevice> device;
  ManualClock clock;
  Controls control;
  std::uint32_t epoch = 1;
  std::uint64_t id = 0;
  double fps = 25.0;
  bool streaming = true;
  double naive_stiffness_N_mm = 0.0;  ///< of the material; 0: the device's own
  double t_s = 0.0;
  std::function<Vec3(double)> target_mm = [](double) { return Vec3(0.1, 0.1, 5.0); };  // nominal
  std::function<void(PlayFrame&, double)> scene;  // at a time of the media
  std::function<void(Scene&)> at_tick;

 private:
  /// From 20 mm above down to the target before the event.
  [[nodiscard]] Vec3 handAt(double t) const {
    const double s = std::clamp((t + 1.6) / 0.6, 0.0, 1.0);
    return target_mm(t) + Vec3(0.0, 0.0, (1.0 - s) * 20.0);
  }
  void stream() {
    const double now_s = toSeconds(clock.now().time_since_epoch());
    while (next_frame_s_ <= now_s) {
      if (streaming) send(next_frame_s_);
      next_frame_s_ += 1.0 / fps;
    }
  }
  void step() {
    const Vec3 before_mm = device->truePosition_mm();
    const DeviceState state = device->exchange(force_N_);
    work_mJ_ += sent_N_[1].dot(device->truePosition_mm() - before_mm);  // the profile's delay is 1
    sent_N_[1] = sent_N_[0];
    const TickReport& report = room->tick(clock.now(), state);
    last_N_ = force_N_;
    force_N_ = naive_ ? naiveForce(report) : report.force_N;
    sent_N_[0] = force_N_;
  }
  /// K d along the surface's push and the dynamic force, clamped: what is found is rendered.
  Vec3 naiveForce(const TickReport& report) {
    const double static_N = report.static_force_N.norm();
    if (static_N > 0.0) direction_ = report.static_force_N / static_N;
    const double k_N_mm =
        naive_stiffness_N_mm != 0.0 ? naive_stiffness_N_mm : settings_.profile.stiffness_N_mm;
    const double spring_N = std::max(0.0, k_N_mm) * report.penetration_mm * report.mapping.scale;
    Vec3 force_N = std::min(spring_N, 1e3) * direction_ + report.dynamic_force_N;
    if (!report.contact) force_N.setZero();
    const double size_N = force_N.norm();
    return size_N > settings_.profile.peak_N ? Vec3(force_N * (settings_.profile.peak_N / size_N))
                                             : force_N;
  }
  void see(CaseOutcome& out, double begin_mJ) {
    const TickReport& report = room->report();
    out.peak_N = std::max(out.peak_N, force_N_.norm());
    out.step_N = std::max(out.step_N, (force_N_ - last_N_).norm());
    out.excess_N = std::max(out.excess_N, report.step_excess_N);
    out.speed_mm_s = std::max(out.speed_mm_s, device->trueVelocity_mm_s().z());
    out.energy_mJ = std::max(out.energy_mJ, work_mJ_ - begin_mJ);
    out.finite = out.finite && force_N_.allFinite();
    out.interferences |= report.interferences;
    out.trace_N.push_back(force_N_.norm());
    out.trace_mm_s.push_back(device->trueVelocity_mm_s().z());
  }

  bool naive_;
  RoomSettings settings_;
  double next_frame_s_ = 0.0;
  Vec3 force_N_ = Vec3::Zero();
  Vec3 last_N_ = Vec3::Zero();
  Vec3 direction_ = Vec3::UnitZ();
  Vec3 sent_N_[2] = {Vec3::Zero(), Vec3::Zero()};
  double work_mJ_ = 0.0;
};

struct RoomCase {
  std::string name;
  std::function<void(Scene&)> set;
};

/// An object of 16 x 16 mm about (0, 0), 10 mm high, 5 mm above where the hand wants to be: flat or
/// a dome. `change` acts on each frame's object; where that moves it, its relief lies in the frame.
void usual(Scene& s, std::function<void(PlayObject&, double)> change = {}, bool dome = false) {
  s.scene = [&s, change, dome](PlayFrame& frame, double t) {
    PlayObject object = makeObject(1, nullptr, {0.0, 0.0, 10.0});
    if (change) change(object, t);
    Vec3& at_mm = object.motion.position_mm;
    const int shift_px = static_cast<int>(std::lround(at_mm.x() / kPixel_mm));
    at_mm.x() = shift_px * kPixel_mm;
    s.naive_stiffness_N_mm = object.material.stiffness_N_mm;
    object.field = s.reliefs.at(shift_px, at_mm.z(), dome);
    s.add(frame, object);
  };
}

void slideAcross(Scene& s, double speed_mm_s) {
  s.target_mm = [=](double t) {
    return Vec3(-7.0 + std::clamp(t, 0.0, 0.58) * speed_mm_s, 0.1, 5.0);
  };
}

void shaped(Scene& s, const PixelRect& rect, const std::function<double(const Vec2&)>& height_mm,
            const std::function<bool(const Vec2&)>& mask) {
  s.scene = [&s, field = makeField(rect, Workspace{}, height_mm, mask)](PlayFrame& frame, double) {
    s.add(frame, makeObject(1, field.get(), {0.0, 0.0, 10.0}));
  };
}

std::vector<RoomCase> shapes() {
  const auto ball = [](double radius_mm) {
    return [=](const Vec2& at) {
      return 10.0 - radius_mm + std::sqrt(std::max(0.0, radius_mm * radius_mm - at.squaredNorm()));
    };
  };
  return {
      {"a 30 mm step in one pixel, slid across at 24 mm/s",
       [](Scene& s) {
         shaped(
             s, kPlate_px, [](const Vec2& at) { return at.x() < 0.0 ? 8.0 : 30.0; },
             [](const Vec2&) { return true; });
         slideAcross(s, 24.0);
       }},
      {"an object of one pixel",
       [](Scene& s) {
         shaped(
             s, {320, 240, 1, 1}, [](const Vec2&) { return 10.0; },
             [](const Vec2&) { return true; });
       }},
      {"a mask of thin stripes, slid across",
       [](Scene& s) {
         shaped(
             s, kPlate_px, [](const Vec2&) { return 10.0; },
             [](const Vec2& at) { return static_cast<int>(std::floor(at.x() * 4.0)) % 2 == 0; });
         slideAcross(s, 24.0);
       }},
      {"an empty mask from the event on",
       [](Scene& s) {
         const Field empty = makeField(
             kPlate_px, Workspace{}, [](const Vec2&) { return 10.0; },
             [](const Vec2&) { return false; });
         s.scene = [&s, empty](PlayFrame& frame, double t) {
           const HeightField* field = t < 0.0 ? s.reliefs.at(0, 10.0, false) : empty.get();
           s.add(frame, makeObject(1, field, {0.0, 0.0, 10.0}));
         };
       }},
      {"depth close to the radius of curvature (3 mm ball, 2.9 mm deep)",
       [ball](Scene& s) {
         shaped(s, {300, 220, 40, 40}, ball(3.0), [](const Vec2& at) { return at.norm() < 2.95; });
         s.target_mm = [](double t) { return Vec3(0.05, 0.05, 7.1 - (t > 0.0 ? 4.0 : 0.0)); };
       }},
      {"a HIP in the corner of the picture",
       [](Scene& s) {
         shaped(
             s, {0, 0, 640, 480}, [](const Vec2&) { return 10.0; },
             [](const Vec2&) { return true; });
         s.target_mm = [](double t) {
           const double out_mm = std::clamp(t, 0.0, 1.0) * 8.0;
           return Vec3(-76.0 - out_mm, 56.0 + out_mm, 5.0);
         };
       }},
      {"a HIP 100 mm outside the workspace and back",
       [](Scene& s) {
         usual(s);
         s.target_mm = [](double t) {
           return Vec3(t > 0.0 && t < 1.0 ? 180.0 : 0.1, 0.1, t > 0.0 && t < 1.0 ? -150.0 : 5.0);
         };
       }},
  };
}

/// 2 mm, 2 m/s² at 30 rad/s.
void shake(PlayObject& object, double t) {
  if (t < 0.0) return;
  object.motion.position_mm.z() -= 2e3 / 900.0 * std::sin(30.0 * t);
  object.motion.velocity_mm_s.z() = -2e3 / 30.0 * std::cos(30.0 * t);
  object.motion.acceleration_mm_s2.z() = 2e3 * std::sin(30.0 * t);
}

std::vector<RoomCase> motions() {
  return {
      {"a dome at 40 px/frame (250 mm/s) to and fro under the finger",
       [](Scene& s) {
         usual(
             s,
             [](PlayObject& object, double t) {
               const double x = t < 0.0 ? 0.0 : 15.0 * std::sin(250.0 / 15.0 * t);
               const double v = t < 0.0 ? 0.0 : 250.0 * std::cos(250.0 / 15.0 * t);
               object.motion.position_mm.x() = x;
               object.motion.velocity_mm_s.x() = v;
             },
             true);
       }},
      {"an object leaving under the finger at 500 mm/s",
       [](Scene& s) {
         usual(s, [](PlayObject& object, double t) {
           object.motion.position_mm.x() = std::clamp(t, 0.0, 0.12) * 500.0;
           object.motion.velocity_mm_s.x() = t < 0.0 || t > 0.12 ? 0.0 : 500.0;
         });
       }},
      {"the frames say nothing of a leap of +-4 mm each frame",
       [](Scene& s) {
         usual(s, [n = 0](PlayObject& object, double t) mutable {
           if (t >= 0.0) object.motion.position_mm.z() += ++n % 2 == 0 ? 4.0 : -4.0;
         });
       }},
      {"two objects overlapping, swapping which is deeper",
       [](Scene& s) {
         s.scene = [&s](PlayFrame& frame, double t) {
           const double by_mm = t < 0.0 ? 0.0 : 2.0 * std::sin(20.0 * t);
           for (const double z_mm : {10.0 + by_mm, 10.0 - by_mm}) {
             const auto number = static_cast<std::uint32_t>(frame.object_count + 1);
             s.add(frame, makeObject(number, s.reliefs.at(0, z_mm, false), {0.0, 0.0, z_mm}));
           }
         };
       }},
      {"mass 0, an object shaken with 2 m/s2",
       [](Scene& s) {
         usual(s, [](PlayObject& object, double t) { shake(object, t); });
         s.control.author_mass_kg = 0.0;
         s.control.largest_acceleration_mm_s2 = 2e3;
       }},
      {"mass 1e6 kg, the same",
       [](Scene& s) {
         usual(s, [](PlayObject& object, double t) { shake(object, t); });
         s.control.author_mass_kg = 1e6;
       }},
      {"material: stiffness, damping, friction denormal, huge, negative",
       [](Scene& s) {
         usual(s, [n = 0](PlayObject& object, double t) mutable {
           constexpr double kValues[] = {5e-324, 1e300, -1.0, 0.5, 1e-9, 1e9};
           if (t < 0.0) return;
           const double value = kValues[++n / 5 % 6];
           object.material = {value, value, value, value, value};
         });
       }},
      {"friction 0, then 10",
       [](Scene& s) {
         usual(s, [](PlayObject& object, double t) {
           object.material.static_friction = object.material.dynamic_friction =
               t < 2.0 ? 0.0 : 10.0;
         });
         s.target_mm = [](double t) { return Vec3(6.0 * std::sin(3.0 * t), 0.1, 5.0); };
       }},
  };
}

std::vector<RoomCase> streams() {
  std::vector<RoomCase> all;
  for (const double stall_s : {0.1, 0.5, 3.5}) {
    all.push_back({text("a stall of %g s of a rising object", stall_s), [stall_s](Scene& s) {
                     usual(s, [](PlayObject& object, double t) {
                       object.motion.position_mm.z() += 3.0 * std::sin(6.0 * t);
                       object.motion.velocity_mm_s.z() = 18.0 * std::cos(6.0 * t);
                     });
                     s.at_tick = [stall_s](Scene& scene) {
                       scene.streaming = scene.t_s < 0.0 || scene.t_s > stall_s;
                     };
                   }});
  }
  for (const double jump_s : {1.0, -1.0}) {
    all.push_back({text("a clock jump of %+g s", jump_s), [jump_s](Scene& s) {
                     usual(s, [](PlayObject& object, double t) {
                       object.motion.position_mm.z() += 3.0 * std::sin(6.0 * t);
                       object.motion.velocity_mm_s.z() = 18.0 * std::cos(6.0 * t);
                     });
                     s.at_tick = [jump_s](Scene& scene) {
                       if (scene.t_s == 0.0) scene.control.clock_offset = fromSeconds(jump_s);
                     };
                   }});
  }
  for (const double fps : {1.0, 240.0}) {
    all.push_back({text("%g frames/s of a moving object", fps), [fps](Scene& s) {
                     s.fps = fps;
                     s.control.frame_interval = fromSeconds(1.0 / fps);
                     s.control.playout_delay_target = fromSeconds(1.2 / fps);
                     usual(s, [](PlayObject& object, double t) {
                       object.motion.position_mm.z() += 3.0 * std::sin(2.0 * t);
                       object.motion.velocity_mm_s.z() = 6.0 * std::cos(2.0 * t);
                     });
                   }});
  }
  all.push_back({"frames in reverse", [](Scene& s) {
                   usual(s);
                   s.at_tick = [n = 0](Scene& scene) mutable {
                     scene.streaming = scene.t_s < 0.0;
                     if (scene.t_s >= 0.0 && ++n % 40 == 0)
                       scene.send(kBegin_s + kEvent_s + 0.5 - scene.t_s);
                   };
                 }});
  all.push_back({"two frames with one time, 3 mm apart", [](Scene& s) {
                   usual(s, [n = 0](PlayObject& object, double t) mutable {
                     if (t >= 0.0) object.motion.position_mm.z() += ++n % 2 == 0 ? 3.0 : 0.0;
                   });
                   s.at_tick = [n = 0](Scene& scene) mutable {
                     scene.streaming = scene.t_s < 0.0;
                     if (scene.t_s < 0.0 || ++n % 40 != 0) return;
                     scene.send(kBegin_s + kEvent_s + scene.t_s);
                     scene.send(kBegin_s + kEvent_s + scene.t_s);
                   };
                 }});
  all.push_back({"pause in contact with a moving object, resume", [](Scene& s) {
                   usual(s, [](PlayObject& object, double t) {
                     object.motion.position_mm.z() += 3.0 * std::sin(6.0 * t);
                     object.motion.velocity_mm_s.z() = 18.0 * std::cos(6.0 * t);
                   });
                   s.at_tick = [](Scene& scene) {
                     scene.control.paused = scene.t_s >= 0.0 && scene.t_s < 1.0;
                   };
                 }});
  all.push_back({"disconnect in contact, reconnect to a scene 3 mm higher", [](Scene& s) {
                   usual(s, [](PlayObject& object, double t) {
                     if (t > 0.5) object.motion.position_mm.z() += 3.0;
                   });
                   s.at_tick = [](Scene& scene) {
                     scene.control.connected = scene.t_s < 0.0 || scene.t_s > 1.0;
                     if (scene.t_s == 1.0) scene.control.first_epoch = ++scene.epoch;
                   };
                 }});
  return all;
}

}  // namespace

std::vector<ExtremeCase> roomCases() {
  std::vector<RoomCase> all = shapes();
  for (const RoomCase& more : motions()) all.push_back(more);
  for (const RoomCase& more : streams()) all.push_back(more);
  std::vector<ExtremeCase> cases(all.size());
  onAllCores(all.size(), [&](std::size_t i) {
    ExtremeCase& out = cases[i];
    out.name = all[i].name;
    out.allowed_N = Scene::settings().profile.peak_N;
    Reliefs reliefs;
    for (const bool naive : {true, false}) {
      const auto scene = std::make_unique<Scene>(naive, reliefs);
      all[i].set(*scene);
      (naive ? out.naive : out.chain) = scene->run();
    }
  });
  return cases;
}

}  // namespace hapticast::evaluate
