// SPDX-License-Identifier: MIT
#include "tests/scenes/held/recipe.hpp"

namespace hapticast::evaluate::held {

namespace {

void drawSensing(const Recipe& recipe, std::uint64_t set, Play& play) {
  Sensing& sensing = play.scene.sensing;
  const DepthSense kinds[] = {DepthSense::kStructured, DepthSense::kFlight, DepthSense::kRoom8,
                              DepthSense::kEstimate8, DepthSense::kEstimate16};
  sensing.kind = set == 1 ? recipe.sense : kinds[play.draw.oneOf(5)];
  const bool estimated =
      sensing.kind == DepthSense::kEstimate8 || sensing.kind == DepthSense::kEstimate16;
  sensing.flicker = estimated ? 0.03 : 0.0;
  if (!estimated && play.draw.chance(0.5)) {
    sensing.beside_px = play.draw.chance(0.5) ? 2.0 : -2.0;
    sensing.below_px = play.draw.between(-1.0, 1.0);
  }
  sensing.exposure_swing = play.draw.chance(0.5) ? play.draw.between(0.08, 0.25) : 0.0;
  sensing.color_noise = recipe.noise * play.draw.between(1.0, 2.5);
  sensing.jpeg_quality = static_cast<int>(play.draw.between(80.0, 94.0));
}

}  // namespace

std::vector<Scene> heldScenes(std::uint64_t set) {
  std::vector<Scene> out;
  std::uint64_t seed = 1000 * set;
  for (const auto* recipes : {&firstRecipes(), &hardRecipes(), &lastRecipes()}) {
    for (const Recipe& recipe : *recipes) {
      if (recipe.draws_as_before) --seed;
      Play play(recipe.name, recipe.plan, seed++);
      recipe.play(play);
      drawSensing(recipe, set, play);
      play.scene.reported_apart = recipe.reported_apart;
      out.push_back(play.scene);
    }
  }
  return out;
}

}  // namespace hapticast::evaluate::held
