// SPDX-License-Identifier: MIT
// Extreme cases through the whole renderer: real frames in, force out, under a virtual clock.
#include <cmath>
#include <limits>
#include <memory>

#include "tests/evaluate/stability/stability_renderer_scene.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct RendererCase {
  std::string name;
  std::function<void(RendererScene&)> set;
};

/// An object of 16 x 16 mm about (0, 0), 10 mm high, 5 mm above where the hand wants to be: flat or
/// a dome. `change` acts on each frame's object; where that moves it, its relief lies in the frame.
void usual(RendererScene& s, const std::function<void(PlayObject&, double)>& change = {},
           bool dome = false) {
  s.scene = [&s, change, dome](PlayFrame& frame, double t) {
    PlayObject object = makeObject(1, nullptr, {0.0, 0.0, 10.0});
    if (change) change(object, t);
    Vec3& at_mm = object.motion.position_mm;
    const int shift_px = static_cast<int>(std::lround(at_mm.x() / kRoomPixel_mm));
    at_mm.x() = shift_px * kRoomPixel_mm;
    s.naive_stiffness_N_mm = object.material.stiffness_N_mm.value_or(0.0);
    object.field = s.reliefs.at(shift_px, at_mm.z(), dome);
    s.add(frame, object);
  };
}

void slideAcross(RendererScene& s, double speed_mm_s) {
  s.target_mm = [=](double t) {
    return Vec3(-7.0 + std::clamp(t, 0.0, 0.58) * speed_mm_s, 0.1, 5.0);
  };
}

void shaped(RendererScene& s, const PixelRect& rect,
            const std::function<double(const Vec2&)>& height_mm,
            const std::function<bool(const Vec2&)>& mask) {
  s.scene = [&s, field = makeField(rect, Workspace{}, height_mm, mask)](PlayFrame& frame, double) {
    s.add(frame, makeObject(1, field.get(), {0.0, 0.0, 10.0}));
  };
}

std::vector<RendererCase> shapes() {
  const auto ball = [](double radius_mm) {
    return [=](const Vec2& at) {
      return 10.0 - radius_mm + std::sqrt(std::max(0.0, radius_mm * radius_mm - at.squaredNorm()));
    };
  };
  return {
      {"a 30 mm step in one pixel, slid across at 24 mm/s",
       [](RendererScene& s) {
         shaped(
             s, kRendererPlate_px, [](const Vec2& at) { return at.x() < 0.0 ? 8.0 : 30.0; },
             [](const Vec2&) { return true; });
         slideAcross(s, 24.0);
       }},
      {"an object of one pixel",
       [](RendererScene& s) {
         shaped(
             s, {320, 240, 1, 1}, [](const Vec2&) { return 10.0; },
             [](const Vec2&) { return true; });
       }},
      {"a mask of thin stripes, slid across",
       [](RendererScene& s) {
         shaped(
             s, kRendererPlate_px, [](const Vec2&) { return 10.0; },
             [](const Vec2& at) { return static_cast<int>(std::floor(at.x() * 4.0)) % 2 == 0; });
         slideAcross(s, 24.0);
       }},
      {"an empty mask from the event on",
       [](RendererScene& s) {
         const std::shared_ptr<const HeightField> empty = makeField(
             kRendererPlate_px, Workspace{}, [](const Vec2&) { return 10.0; },
             [](const Vec2&) { return false; });
         s.scene = [&s, empty](PlayFrame& frame, double t) {
           const HeightField* field = t < 0.0 ? s.reliefs.at(0, 10.0, false) : empty.get();
           s.add(frame, makeObject(1, field, {0.0, 0.0, 10.0}));
         };
       }},
      {"depth close to the radius of curvature (3 mm ball, 2.9 mm deep)",
       [ball](RendererScene& s) {
         shaped(s, {300, 220, 40, 40}, ball(3.0), [](const Vec2& at) { return at.norm() < 2.95; });
         s.target_mm = [](double t) { return Vec3(0.05, 0.05, 7.1 - (t > 0.0 ? 4.0 : 0.0)); };
       }},
      {"a HIP in the corner of the picture",
       [](RendererScene& s) {
         shaped(
             s, {0, 0, 640, 480}, [](const Vec2&) { return 10.0; },
             [](const Vec2&) { return true; });
         s.target_mm = [](double t) {
           const double out_mm = std::clamp(t, 0.0, 1.0) * 8.0;
           return Vec3(-76.0 - out_mm, 56.0 + out_mm, 5.0);
         };
       }},
      {"a HIP 100 mm outside the workspace and back",
       [](RendererScene& s) {
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

std::vector<RendererCase> motions() {
  return {
      {"a dome at 40 px/frame (250 mm/s) to and fro under the finger",
       [](RendererScene& s) {
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
       [](RendererScene& s) {
         usual(s, [](PlayObject& object, double t) {
           object.motion.position_mm.x() = std::clamp(t, 0.0, 0.12) * 500.0;
           object.motion.velocity_mm_s.x() = t < 0.0 || t > 0.12 ? 0.0 : 500.0;
         });
       }},
      {"the frames say nothing of a leap of +-4 mm each frame",
       [](RendererScene& s) {
         usual(s, [n = 0](PlayObject& object, double t) mutable {
           if (t >= 0.0) object.motion.position_mm.z() += ++n % 2 == 0 ? 4.0 : -4.0;
         });
       }},
      {"two objects overlapping, swapping which is deeper",
       [](RendererScene& s) {
         s.scene = [&s](PlayFrame& frame, double t) {
           const double by_mm = t < 0.0 ? 0.0 : 2.0 * std::sin(20.0 * t);
           for (const double z_mm : {10.0 + by_mm, 10.0 - by_mm}) {
             const auto number = static_cast<std::uint32_t>(frame.object_count + 1);
             s.add(frame, makeObject(number, s.reliefs.at(0, z_mm, false), {0.0, 0.0, z_mm}));
           }
         };
       }},
      {"mass 0, an object shaken with 2 m/s2",
       [](RendererScene& s) {
         usual(s, [](PlayObject& object, double t) { shake(object, t); });
         s.stream.author_mass_kg = 0.0;
         s.stream.largest_acceleration_mm_s2 = 2e3;
       }},
      {"mass 1e6 kg, the same",
       [](RendererScene& s) {
         usual(s, [](PlayObject& object, double t) { shake(object, t); });
         s.stream.author_mass_kg = 1e6;
       }},
      {"material: stiffness, damping, friction denormal, huge, negative",
       [](RendererScene& s) {
         usual(s, [n = 0](PlayObject& object, double t) mutable {
           constexpr double kValues[] = {5e-324, 1e300, -1.0, 0.5, 1e-9, 1e9};
           if (t < 0.0) return;
           const double value = kValues[++n / 5 % 6];
           object.material = {value, value, value, value, value, value};
         });
       }},
      {"friction 0, then 10",
       [](RendererScene& s) {
         usual(s, [](PlayObject& object, double t) {
           object.material.static_friction = object.material.dynamic_friction =
               t < 2.0 ? 0.0 : 10.0;
         });
         s.target_mm = [](double t) { return Vec3(6.0 * std::sin(3.0 * t), 0.1, 5.0); };
       }},
  };
}

std::vector<RendererCase> streams() {
  std::vector<RendererCase> all;
  for (const double stall_s : {0.1, 0.5, 3.5}) {
    all.push_back(
        {text("a stall of %g s of a rising object", stall_s), [stall_s](RendererScene& s) {
           usual(s, [](PlayObject& object, double t) {
             object.motion.position_mm.z() += 3.0 * std::sin(6.0 * t);
             object.motion.velocity_mm_s.z() = 18.0 * std::cos(6.0 * t);
           });
           s.at_tick = [stall_s](RendererScene& scene) {
             scene.streaming = scene.t_s < 0.0 || scene.t_s > stall_s;
           };
         }});
  }
  for (const double jump_s : {1.0, -1.0}) {
    all.push_back({text("a clock jump of %+g s", jump_s), [jump_s](RendererScene& s) {
                     usual(s, [](PlayObject& object, double t) {
                       object.motion.position_mm.z() += 3.0 * std::sin(6.0 * t);
                       object.motion.velocity_mm_s.z() = 18.0 * std::cos(6.0 * t);
                     });
                     s.at_tick = [jump_s](RendererScene& scene) {
                       if (scene.t_s == 0.0) scene.stream.clock_offset = fromSeconds(jump_s);
                     };
                   }});
  }
  for (const double fps : {1.0, 240.0}) {
    all.push_back({text("%g frames/s of a moving object", fps), [fps](RendererScene& s) {
                     s.fps = fps;
                     s.stream.frame_interval = fromSeconds(1.0 / fps);
                     s.stream.playout_delay_target = fromSeconds(1.2 / fps);
                     usual(s, [](PlayObject& object, double t) {
                       object.motion.position_mm.z() += 3.0 * std::sin(2.0 * t);
                       object.motion.velocity_mm_s.z() = 6.0 * std::cos(2.0 * t);
                     });
                   }});
  }
  all.push_back({"frames in reverse", [](RendererScene& s) {
                   usual(s);
                   s.at_tick = [n = 0](RendererScene& scene) mutable {
                     scene.streaming = scene.t_s < 0.0;
                     if (scene.t_s >= 0.0 && ++n % 40 == 0)
                       scene.send(RendererScene::kBegin_s + RendererScene::kEvent_s + 0.5 -
                                  scene.t_s);
                   };
                 }});
  all.push_back({"two frames with one time, 3 mm apart", [](RendererScene& s) {
                   usual(s, [n = 0](PlayObject& object, double t) mutable {
                     if (t >= 0.0) object.motion.position_mm.z() += ++n % 2 == 0 ? 3.0 : 0.0;
                   });
                   s.at_tick = [n = 0](RendererScene& scene) mutable {
                     scene.streaming = scene.t_s < 0.0;
                     if (scene.t_s < 0.0 || ++n % 40 != 0) return;
                     scene.send(RendererScene::kBegin_s + RendererScene::kEvent_s + scene.t_s);
                     scene.send(RendererScene::kBegin_s + RendererScene::kEvent_s + scene.t_s);
                   };
                 }});
  all.push_back({"pause in contact with a moving object, resume", [](RendererScene& s) {
                   usual(s, [](PlayObject& object, double t) {
                     object.motion.position_mm.z() += 3.0 * std::sin(6.0 * t);
                     object.motion.velocity_mm_s.z() = 18.0 * std::cos(6.0 * t);
                   });
                   s.at_tick = [](RendererScene& scene) {
                     scene.user.paused = scene.t_s >= 0.0 && scene.t_s < 1.0;
                   };
                 }});
  all.push_back({"disconnect in contact, reconnect to a scene 3 mm higher", [](RendererScene& s) {
                   usual(s, [](PlayObject& object, double t) {
                     if (t > 0.5) object.motion.position_mm.z() += 3.0;
                   });
                   s.at_tick = [](RendererScene& scene) {
                     scene.stream.connected = scene.t_s < 0.0 || scene.t_s > 1.0;
                     if (scene.t_s == 1.0) scene.stream.first_epoch = ++scene.epoch;
                   };
                 }});
  return all;
}

}  // namespace

std::vector<ExtremeCase> rendererCases() {
  std::vector<RendererCase> all = shapes();
  for (const RendererCase& more : motions()) all.push_back(more);
  for (const RendererCase& more : streams()) all.push_back(more);
  std::vector<ExtremeCase> cases(all.size());
  onAllCores(all.size(), [&](std::size_t i) {
    ExtremeCase& out = cases[i];
    out.name = all[i].name;
    out.allowed_N = client::RendererSettings{}.profile.peak_N;
    RendererReliefs reliefs;
    for (const bool naive : {true, false}) {
      const auto scene = std::make_unique<RendererScene>(naive, reliefs);
      all[i].set(*scene);
      (naive ? out.naive : out.chain) = scene->run();
    }
  });
  return cases;
}

}  // namespace hapticast::evaluate
