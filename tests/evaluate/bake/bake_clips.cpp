// SPDX-License-Identifier: MIT
#include "tests/evaluate/bake/bake_clips.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tests/scenes/body_scene.hpp"
#include "tests/scenes/held/scene.hpp"

namespace hapticast::evaluate {

namespace {

BakeClip drawBodies(const TestScene& scene, const Sensor& sensor) {
  TestSource source(scene, sensor, 25.0, true);
  BakeClip out{source.info(), {}, {}, scene.impacts_s};
  while (auto frame = source.read()) {
    const TestSource::Truth truth = source.truth(frame->index);
    out.truth.push_back({truth.mask, truth.depth, truth.centre.acceleration_mm_s2});
    out.frames.push_back(std::move(*frame));
  }
  return out;
}

BakeClip drawHeld(const held::Scene& scene) {
  constexpr std::uint64_t kMost = 75;
  const held::Film film(scene, {640, 480});
  BakeClip out{film.info(), {}, {}, {}};
  out.info.frame_count = std::min(kMost, out.info.frame_count.value_or(kMost));
  for (std::uint64_t i = 0; i < *out.info.frame_count; ++i) {
    held::Film::Shot shot = film.shoot(i);
    shot.frame.mask = shot.truth.mask() / 255;
    out.truth.push_back({shot.truth.mask(), shot.truth.depth, std::nullopt});
    out.frames.push_back(std::move(shot.frame));
  }
  return out;
}

}  // namespace

std::vector<NamedBakeClip> bakeClips(bool quick) {
  struct NamedSensor {
    const char* name;
    Sensor::Depth depth;
  };
  constexpr std::array kSensors{NamedSensor{"stereo", Sensor::Depth::kStereo},
                                NamedSensor{"time of flight", Sensor::Depth::kTimeOfFlight},
                                NamedSensor{"8 bit", Sensor::Depth::kEightBit}};
  constexpr std::array kQuick{"general", "still", "bounce_real"};
  std::vector<TestScene> scenes = motionScenes();
  for (TestScene& scene : segmentationScenes()) scenes.push_back(std::move(scene));
  std::vector<NamedBakeClip> out;
  for (const TestScene& scene : scenes) {
    if (quick && std::find(kQuick.begin(), kQuick.end(), scene.name) == kQuick.end()) continue;
    for (const NamedSensor& named : kSensors) {
      if (quick && named.depth == Sensor::Depth::kEightBit) continue;
      Sensor sensor;
      sensor.depth = named.depth;
      out.push_back({scene.name + ", " + named.name, [=] { return drawBodies(scene, sensor); }});
    }
  }
  std::size_t held_scenes = 0;
  for (const held::Scene& scene : held::heldScenes(1)) {
    if (quick && ++held_scenes > 1) break;
    out.push_back({"held " + scene.name, [=] { return drawHeld(scene); }});
  }
  return out;
}

}  // namespace hapticast::evaluate
