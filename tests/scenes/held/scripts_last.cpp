// SPDX-License-Identifier: MIT
// Held scenes that were drawn when the method of vision stood: no method was tuned on them. Hands,
// lights, cameras and things that the other lists do not have. In the table's frame.
#include <cmath>

#include "tests/scenes/held/recipe.hpp"

namespace hapticast::evaluate::held {

namespace {

const StagePlan kStand{0.72, 600.0, 80.0, false, true};  // a phone on a stand
const StagePlan kLow{0.2, 660.0, 95.0, true, true};      // on the table
const StagePlan kHigh{0.34, 790.0, 150.0, true, true};   // on a screen
const StagePlan kNear{0.52, 400.0, 75.0, true, true};    // at arm's length of the person
const StagePlan kBody{0.14, 730.0, 165.0, true, false};  // looks at the person
constexpr double kPi = 3.14159265358979;

// The light of a lamp and of the room, over the one that was drawn: blue, green, red.
void setLight(Play& p, const Color& lamp, const Color& around) {
  p.scene.light.lamp = p.scene.light.lamp.cwiseProduct(lamp);
  p.scene.light.around = p.scene.light.around.cwiseProduct(around);
}

void setSkin(Play& p, const Color& color) {
  for (const std::size_t paint : {p.skin, p.fingertip})
    p.scene.paints[paint].color = p.scene.paints[paint].second = color;
}

// A little lighter or darker than this.
Color drawNear(Play& p, double red, double green, double blue) {
  const double level = p.draw.between(0.9, 1.06);
  return screen(level * red, level * green, level * blue);
}

Paint& objectPaint(Play& p) { return p.scene.paints[p.scene.object.paint]; }

// In the evening, in a dark hand; it shows its handle, then its inside.
void darkMug(Play& p) {
  p.object(Kind::kMug, p.at(-5, 100, 0), -2.7);
  setSkin(p, drawNear(p, 84, 53, 40));
  Paint& paint = objectPaint(p);
  paint.pattern = Pattern::kPlain;
  paint.color = drawNear(p, 45, 50, 67);
  setLight(p, {0.62F, 0.9F, 1.18F}, {0.72F, 0.92F, 1.08F});
  p.way().move({0.2, 1.1}, p.at(-30, 20, 25)).move({1.2, 2.1}, p.at(40, 5, 15));
  p.swing({0.2, 1.2}, {0.1, 1, 0}, 0.85);
  p.swing({1.2, 2.0}, {1, 0.1, 0}, 0.6);
  p.finishObject();
  holdThroughout(p, personsHand(p, kHand, true),
                 p.gripFrom(p.at(1, -0.05, -0.1), 40, p.at(0, 0.2, 1)));
}

// Lets go, moves to `to` and holds the thing there.
void regrip(HandScript& hand, const Pose& from, const Pose& to, const Vec3& aside_mm, double at_s) {
  const auto off = [&](const Pose& grip) { return Pose{grip.turn, grip.at_mm + aside_mm}; };
  hand.stations = {Play::on(0, from, 1),
                   Play::on(at_s, from, 1),
                   Play::on(at_s + 0.18, off(from), 0.3),
                   Play::on(at_s + 0.4, off(to), 0.3),
                   Play::on(at_s + 0.58, to, 1),
                   Play::on(9, to, 1)};
}

// Cloth of three colours, white muzzle; one hand after the other takes hold elsewhere.
void patchedToy(Play& p) {
  p.object(Kind::kBear, p.at(0, 95, 0), 0.1);
  Paint& cloth = objectPaint(p);
  cloth.pattern = Pattern::kPatches;
  cloth.color = drawNear(p, 200, 140, 70);
  cloth.second = drawNear(p, 70, 86, 122);
  Paint& muzzle = p.scene.paints[p.scene.object.paint + 1];
  muzzle.color = screen(246, 244, 238);
  muzzle.second = screen(220, 214, 204);
  p.way().move({0.1, 0.9}, p.at(15, 20, 15)).move({1.1, 2.1}, p.at(-30, -15, 10));
  p.swing({0.1, 1.0}, {0, 1, 0.1}, 0.35);
  p.swing({1.1, 2.1}, {0.3, -1, 0.3}, 0.5);
  p.finishObject();
  for (const bool right : {true, false}) {
    const double x = right ? 1.0 : -1.0;
    HandScript hand = personsHand(p, right ? kHand : kOtherHand, right);
    hand.look.has_sleeve = false;
    // At the body with the thumb up, and at the cheek with the fingers up.
    const Pose low = p.gripFrom(p.at(x, 0.05, -0.35), 52, p.at(0.1 * x, 0.1, 1));
    Pose high = p.gripFrom(p.at(x, -0.1, -0.3), 49, p.at(0, 0.9, 0.5));
    high.at_mm += Vec3(0, 70, 0);
    p.close(hand, low);
    const Vec3 aside = Vec3(p.mirror * x * 32, 6, -20);
    regrip(hand, right ? low : high, right ? high : low, aside, right ? 0.55 : 1.3);
    p.scene.hands.push_back(hand);
  }
  p.scene.held_at_start = true;
}

// Of the colour of the pale hand that turns it over.
void woodenBlock(Play& p) {
  p.object(Kind::kBox, p.at(-25, 95, 0), 0.3, 0.78);
  setSkin(p, drawNear(p, 240, 206, 186));
  Paint& wood = objectPaint(p);
  wood.pattern = Pattern::kWood;
  wood.color = screen(228, 188, 146);
  wood.second = screen(206, 160, 116);
  wood.gloss = 0.1F;
  p.way().move({0.2, 1.0}, p.at(20, 25, 25)).move({1.1, 2.1}, p.at(-35, -15, -30));
  p.swing({0.2, 1.1}, {0, 0.3, 1}, 0.7);
  p.swing({1.1, 2.1}, {0.2, 0.9, -0.5}, 0.8);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, p.at(250, 60, 330));
  hand.look.has_sleeve = true;
  hand.look.sleeve_from = 0.5;  // rolled up
  holdThroughout(p, hand, p.gripFrom(p.at(1, 0, 0.1), 37.5, p.at(-0.1, 0.1, -1)));
}

// A pose on the tube `along_mm` from its middle.
Pose gripOnTube(const Play& p, double along_mm, const Vec3& from, const Vec3& fingers) {
  Pose grip = p.gripFrom(from, 20, fingers);
  grip.at_mm += Vec3(p.mirror * along_mm, 0, 0);
  return grip;
}

// From one hand to the other of the same person, in low light.
void tubeHandedOver(Play& p) {
  p.object(Kind::kTube, p.at(-10, 110, 0), 0.1, 0.8);
  Paint& paint = objectPaint(p);
  paint.pattern = Pattern::kStripes;
  paint.second = anyColor(p.draw);
  paint.scale_mm = 15.0;
  setLight(p, {0.3F, 0.36F, 0.42F}, {0.42F, 0.45F, 0.48F});
  p.way().move({0.1, 0.8}, p.at(40, 10, 10)).move({1.4, 2.1}, p.at(-70, 15, 15));
  p.swing({0.1, 0.9}, {0.1, 0.4, 1}, 0.25);
  p.swing({1.4, 2.15}, {0.2, 1, -0.6}, 0.5);
  p.finishObject();
  HandScript giver = personsHand(p, kHand, true);
  const Pose grip = gripOnTube(p, 85, p.at(0.1, 0.8, -0.6), p.at(-0.1, 0.2, 1));
  p.close(giver, grip);
  giver.stations = {Play::on(0, grip, 1), Play::on(1.2, grip, 1), Play::on(1.38, grip, 0),
                    p.off(2.0, grip, 1.38, p.at(90, 5, -90))};
  HandScript taker = personsHand(p, kOtherHand, false);
  taker.look.has_sleeve = giver.look.has_sleeve;
  const Pose other = gripOnTube(p, -75, p.at(-0.1, -1, -0.25), p.at(0.1, -0.1, 1));
  p.close(taker, other);
  taker.stations = {p.off(0.3, other, 0.8, p.at(-120, -25, -90)), Play::on(0.95, other, 0),
                    Play::on(1.15, other, 1), Play::on(9, other, 1)};
  p.scene.hands = {giver, taker};
  p.scene.held_at_start = true;
}

// By its neck, through half a turn.
void bottleUpsideDown(Play& p) {
  const double size = 0.9;
  p.object(Kind::kBottle, p.at(-10, 90, 0), 0.3, size);
  const double neck_mm = 112.0 * size;
  const Ease turned{0.25, 1.95};
  // The hand stays where it is, nearly: the bottle goes round it.
  p.way().move(turned, p.at(25, 1.2 * neck_mm, 20));
  p.way().move({0.3, 1.1}, p.at(75, 10, 0)).move({1.1, 1.9}, p.at(-75, 0, 0));
  p.swing(turned, {0, 0, 1}, kPi);
  p.finishObject();
  Pose grip = p.gripFrom(p.at(1, 0, -0.25), 13.5 * size, p.at(0.1, 0.05, 1));
  grip.at_mm += Vec3(0, neck_mm + 8.0, 0);
  holdThroughout(p, personsHand(p, kHand, true), grip);
}

// Lies on the open hand, which tilts.
void boxOnPalm(Play& p) {
  constexpr double kSize = 0.42;
  p.object(Kind::kBox, p.at(5, 85, 10), 0.4, kSize);
  objectPaint(p).scale_mm = 13.0;
  p.swing({-2, -1}, {1, 0, 0}, -0.5 * kPi);  // it lies from the beginning
  p.way().move({0.15, 0.8}, p.at(-20, 12, 5)).move({1.2, 2.1}, p.at(35, 0, -15));
  p.swing({0.2, 0.9}, {0.2, 0, 1}, 0.3);
  p.swing({1.0, 1.5}, {1, 0, 0.1}, 0.28);
  p.swing({1.5, 2.15}, {0.2, 0, 1}, -0.4);
  p.finishObject();
  HandScript hand = personsHand(p, kHand, true);
  const Vec3 fingers = p.at(-0.35, 0.1, 1).normalized();
  Pose grip = p.gripFrom(p.at(0, -1, 0), 30.0 * kSize + 4.0, fingers);
  grip.at_mm += p.way().at(0.0).pose.turn.transpose() * (14.0 * fingers);
  hand.stations = {Play::on(0, grip, 0), Play::on(9, grip, 0)};
  p.scene.hands = {hand};
  p.scene.held_at_start = true;
}

// Between two hands before a patterned shirt.
void ballBeforeShirt(Play& p) {
  Paint& shirt = p.scene.paints[p.shirt];
  shirt.pattern = Pattern::kChecks;
  shirt.second = anyColor(p.draw);
  shirt.scale_mm = p.draw.between(24.0, 36.0);
  p.object(Kind::kBall, p.person_mm + Vec3(0, 165, 205), 0.2, 1.3);
  p.way().move({0.2, 1.0}, p.at(20, 20, 20)).move({1.1, 2.1}, p.at(-45, -15, 5));
  p.swing({0.2, 1.1}, {0.1, 1, 0}, 0.5);
  p.swing({1.1, 2.1}, {1, -0.5, 0.3}, 0.55);
  p.finishObject();
  for (const bool right : {true, false}) {
    const double x = right ? 1.0 : -1.0;
    holdThroughout(p, personsHand(p, right ? kHand : kOtherHand, right),
                   p.gripFrom(p.at(x, -0.3, -0.3), 62, p.at(-0.1 * x, 0.8, 0.5)));
  }
}

// Under a lamp from the side; it goes out of the picture by half and returns.
void mugHalfOut(Play& p) {
  p.object(Kind::kMug, p.at(40, 90, 10), 2.6);
  p.scene.light.towards = (p.to_camera.turn * p.at(-1, 0.55, 0.35)).normalized();
  setLight(p, {1.45F, 1.5F, 1.55F}, {0.5F, 0.5F, 0.5F});
  const Vec3 begin = p.way().at(0.0).pose.at_mm;
  const double border_mm = 0.5 * p.to_camera.out(begin).z() / p.scene.focal_share;
  const double way_mm = border_mm - begin.x() * p.mirror;
  p.way().move({0.2, 1.05}, p.at(way_mm, 15, 0)).move({1.2, 2.0}, p.at(20 - way_mm, -5, 10));
  p.swing({0.2, 1.0}, {0, 1, 0}, -0.4);
  p.swing({1.2, 2.1}, {0.3, 1, 0.4}, 0.5);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, p.at(230, 60, 400));
  hand.elbow_follows = 0.7;
  holdThroughout(p, hand, p.gripFrom(p.at(1, 0, 0.1), 40, p.at(0, 0.15, -1)));
}

}  // namespace

const std::vector<Recipe>& lastRecipes() {
  static const std::vector<Recipe> all{
      {"dark_mug", DepthSense::kFlight, kLow, darkMug, false, true},
      {"patched_toy", DepthSense::kStructured, kAcross, patchedToy, false, true},
      {"wooden_block", DepthSense::kRoom8, kStand, woodenBlock, false, true},
      {"tube_handed_over", DepthSense::kEstimate16, kAcross, tubeHandedOver, false, true, 3.5},
      {"upside_down", DepthSense::kRoom8, kHigh, bottleUpsideDown, false, true},
      {"lies_on_palm", DepthSense::kStructured, kNear, boxOnPalm, false, true},
      {"before_shirt", DepthSense::kFlight, kBody, ballBeforeShirt, false, true},
      {"half_out", DepthSense::kEstimate8, kAcross, mugHalfOut, false, true},
  };
  return all;
}

}  // namespace hapticast::evaluate::held
