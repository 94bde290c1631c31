// SPDX-License-Identifier: MIT
// Held scenes with what misleads vision in real recordings: holes, rims of another colour, bare
// arms, things that touch, things that are large, small or flat. In the table's frame.
#include <cmath>

#include "tests/scenes/held/recipe.hpp"

namespace hapticast::evaluate::held {

namespace {

const StagePlan kFromAbove{0.62, 570.0, 70.0, true, true};
constexpr double kBallRadius_mm = 44.0;  // of the ball that the cup takes

// Dark red, cream rim, its handle beside it in the picture; the camera balances its colours late.
void mugRim(Play& p) {
  p.object(Kind::kMug, p.at(-10, 95, 0), 2.95);
  Paint& paint = p.scene.paints[p.scene.object.paint];
  paint.pattern = Pattern::kRim;
  paint.color = screen(p.draw.between(112, 140), p.draw.between(42, 62), p.draw.between(38, 54));
  paint.second = screen(236, 222, 190);
  paint.scale_mm = 36.0;
  p.way().move({0.3, 1.2}, p.at(-15, 25, 30)).move({1.3, 2.1}, p.at(35, -25, -20));
  p.swing({0.4, 1.3}, {0.2, 1, 0.2}, 0.5);
  p.swing({1.2, 2.1}, {0.3, -0.5, 1}, 0.45);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, viewersElbow(p));
  hand.look.has_sleeve = false;
  holdThroughout(p, hand, p.gripFrom(p.at(1, 0, 0.1), 40, p.at(0, 0.15, -1)));
  p.scene.sensing.green_cast = p.draw.between(0.12, 0.22);
}

void colorLikeSkin(Play& p) {
  Paint& fur = p.scene.paints[p.scene.object.paint];
  fur.color = p.scene.paints[p.skin].color.cwiseProduct(Color(0.7F, 0.8F, 0.88F));
  fur.second = 0.6F * fur.color;
  Paint& muzzle = p.scene.paints[p.scene.object.paint + 1];
  muzzle.color = screen(244, 240, 232);
  muzzle.second = screen(214, 204, 190);
  muzzle.holes = 0.75F;
}

// Brown as the hands are; the depth camera does not see its muzzle and nose.
void toyMuzzle(Play& p) {
  p.object(Kind::kBear, p.at(0, 60, 0), 0.15);
  colorLikeSkin(p);
  p.way().move({0.3, 0.95}, p.at(20, 70, 20)).move({1.2, 2.0}, p.at(-50, -20, 20));
  p.swing({0.5, 1.3}, {0, 1, 0.1}, 0.55);
  p.swing({1.2, 2.1}, {0.2, -0.6, 1}, -0.4);
  p.finishObject();
  holdThroughout(p, personsHand(p, kHand, true),
                 p.gripFrom(p.at(1, 0.05, -0.35), 44, p.at(0.1, 0.1, 1)));
  holdThroughout(p, personsHand(p, kOtherHand, false),
                 p.gripFrom(p.at(-0.3, 1, -0.15), 106, p.at(0.5, -0.1, 0.8)));
}

void boxOnArm(Play& p, bool sleeve) {
  p.object(Kind::kBox, p.at(-20, 100, 0), 0.35);
  p.way().move({0.2, 1.1}, p.at(-35, 25, 20)).move({1.1, 2.1}, p.at(60, -35, -10));
  p.swing({0.4, 1.3}, {0, 1, 0.3}, 0.5);
  p.swing({1.2, 2.1}, {0.2, 0, 1}, -0.4);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, p.at(420, 10, 200));
  hand.look.has_sleeve = sleeve;
  hand.look.sleeve_from = 0.04;
  holdThroughout(p, hand, p.gripFrom(p.at(1, 0, 0.15), 48, p.at(-0.1, 0.15, -1)));
}
void boxBareArm(Play& p) { boxOnArm(p, false); }
void boxSleeve(Play& p) { boxOnArm(p, true); }

// It lies in the palm; the fingers close between it and the camera and open again.
void ballInPalm(Play& p) {
  p.object(Kind::kBall, p.at(0, 75, 0), 0.3, 0.45);
  p.way().move({0.15, 0.75}, p.at(-25, 15, 0)).move({1.2, 2.1}, p.at(45, -5, -20));
  p.finishObject();
  HandScript hand = personsHand(p, kHand, true);
  const Vec3 fingers = p.at(-0.3, 0.15, 1).normalized();
  Pose grip = p.gripFrom(p.at(-0.1, -1, -0.25), 21, fingers);
  grip.at_mm += p.way().at(0.0).pose.turn.transpose() * (12.0 * fingers);  // nearer to the wrist
  p.close(hand, grip);
  hand.stations = {Play::on(0, grip, 0),   Play::on(0.5, grip, 0), Play::on(0.9, grip, 1),
                   Play::on(1.3, grip, 1), Play::on(1.7, grip, 0), Play::on(9, grip, 0)};
  p.scene.hands = {hand};
  p.scene.held_at_start = true;
}

// Another hand puts a ball on the cup's rim, moves along with it and takes it away.
void cupTakesBall(Play& p) {
  p.object(Kind::kMug, p.at(0, 75, 10), 2.2);
  const Ease together{0.85, 1.4};
  p.way().move(together, p.at(25, 10, 15));
  p.finishObject();
  holdThroughout(p, p.hand(kHand, true, viewersElbow(p)),
                 p.gripFrom(p.at(1, -0.05, 0.15), 40, p.at(0, 0.1, -1)));
  Thing ball;
  ball.id = kOther;
  ball.parts = {
      makePart(Form::kEllipsoid, Vec3::Constant(kBallRadius_mm), Vec3::Zero(),
               p.add({Pattern::kBlotches, anyColor(p.draw), anyColor(p.draw), 30.0, 0.2F, 0.0F}))};
  Path way({Mat3::Identity(), p.at(-170, 210, -60)});
  way.move({0.1, 0.8}, p.at(170, -62, 70)).move(together, p.at(25, 10, 15));
  way.move({1.45, 2.1}, p.at(-190, 50, -70));
  p.scene.props = {{ball, way.in(p.to_camera)}};
  HandScript hand = personsHand(p, kOtherHand, false);
  const Vec3 fingers = p.at(0.1, 0.75, 0.55).normalized();
  const Vec3 palm = p.at(0.95, -0.2, 0.2).normalized();
  const Pose grip = handAt(-(kBallRadius_mm + 13.0) * palm - 20.0 * fingers, palm, fingers);
  hand.grip = closedOn(ball, hand.look, grip);
  hand.stations = {{0, Station::On::kProp, grip, 1, Vec3::Zero()},
                   {9, Station::On::kProp, grip, 1, Vec3::Zero()}};
  p.scene.hands.push_back(hand);
}

void addStill(Play& p, const Part& part) {
  Thing thing;
  thing.id = kOther;
  thing.parts = {part};
  if (p.scene.paints[part.paint].pattern == Pattern::kFur) thing.fur_mm = 1.3;
  thing.pose = p.to_camera;
  p.scene.room.push_back(thing);
}

// A tenth of the picture, beside something large that stands as near.
void tenthBesideStill(Play& p) {
  p.object(Kind::kBox, p.at(55, 112, 0), 0.1, 1.45);
  p.way().move({0.2, 1.0}, p.at(-25, 10, 15)).move({1.0, 2.1}, p.at(45, -10, -15));
  p.swing({0.3, 1.2}, {0, 1, 0}, 0.3);
  p.swing({1.2, 2.1}, {0, 0.2, 1}, -0.25);
  p.finishObject();
  const std::size_t paint =
      p.add({Pattern::kChecks, anyColor(p.draw), anyColor(p.draw), 34.0, 0.1F, 0.0F});
  addStill(p, makePart(Form::kBox, {70, 100, 45}, p.at(-120, 100, -10), paint));
  holdThroughout(p, p.hand(kHand, true, p.at(400, 20, 300)),
                 p.gripFrom(p.at(1, -0.1, 0.1), 70, p.at(0, 0.15, -1)));
}

// Between thumb and index finger.
void smallThing(Play& p) {
  p.object(Kind::kBall, p.at(0, 80, 40), 0.4, 0.27);
  p.way().move({0.2, 1.0}, p.at(-45, 20, 10)).move({1.1, 2.1}, p.at(75, 5, -10));
  p.finishObject();
  HandScript hand = personsHand(p, kHand, true);
  const Pinch pinch = pinchOf(hand.look, 23.0);
  hand.grip = pinch.curls;
  Pose in_table = handAt(Vec3::Zero(), p.at(-0.5, -0.55, 0.6), p.at(-0.8, 0.3, 0.35));
  in_table.at_mm = p.way().at(0.0).pose.at_mm - in_table.turn * pinch.middle_mm;
  const Pose begin = p.way().at(0.0).pose;
  const Pose grip{begin.turn.transpose() * in_table.turn, begin.in(in_table.at_mm)};
  hand.stations = {Play::on(0, grip, 1), Play::on(9, grip, 1)};
  p.scene.hands = {hand};
  p.scene.held_at_start = true;
}

// Its front faces the camera.
void flatFront(Play& p) {
  p.object(Kind::kTablet, p.at(0, 100, 20), 0.0);
  p.swing({-2, -1}, {1, 0, 0}, -kAcross.pitch_rad);  // as it is from the beginning
  p.way().move({0.2, 1.0}, p.at(25, 15, 20)).move({1.1, 2.1}, p.at(-45, -10, -15));
  p.swing({0.5, 1.3}, {0, 1, 0}, 0.25);
  p.swing({1.3, 2.1}, {0.3, 0.2, 1}, -0.2);
  p.finishObject();
  for (const bool right : {true, false}) {
    const double x = right ? 1.0 : -1.0;
    HandScript hand = p.hand(right ? kHand : kOtherHand, right, p.at(x * 330, -10, 380));
    if (!right) hand.look.has_sleeve = p.scene.hands.front().look.has_sleeve;
    holdThroughout(p, hand, p.gripFrom(p.at(x, -0.15, 0.1), 84, p.at(-0.1 * x, 0.5, -1)));
  }
}

// Two hands press it and let go; a cushion touches it.
void bearUnderHands(Play& p) {
  p.object(Kind::kBear, p.at(15, 54, -10), -0.1);
  p.finishObject();
  const std::size_t paint =
      p.add({Pattern::kFur, anyColor(p.draw), anyColor(p.draw), 12.0, 0.0F, 0.05F});
  addStill(p, makePart(Form::kEllipsoid, {58, 50, 46}, p.at(-112, 47, 0), paint));
  const Vec3 sides[] = {p.at(1, 0.1, -0.3), p.at(-0.35, 1, -0.15)};
  const Vec3 fingers[] = {p.at(0.1, 0.15, 1), p.at(0.5, -0.1, 0.8)};
  const double distances_mm[] = {46.0, 106.0};
  for (std::size_t i = 0; i < 2; ++i) {
    HandScript hand = personsHand(p, i == 0 ? kHand : kOtherHand, i == 0);
    const Pose grip = p.gripFrom(sides[i], distances_mm[i], fingers[i]);
    const Pose pressed = p.gripFrom(sides[i], distances_mm[i] - 9.0, fingers[i]);
    p.close(hand, grip);
    hand.stations = {Play::on(0, grip, 0.85),   Play::on(0.3, grip, 0.85),
                     Play::on(0.6, pressed, 1), Play::on(0.9, pressed, 1),
                     Play::on(1.2, grip, 0.8),  Play::on(1.5, pressed, 1),
                     Play::on(1.9, grip, 0.5),  Play::on(9, grip, 0.5)};
    p.scene.hands.push_back(hand);
  }
  p.scene.held_at_start = true;
}

}  // namespace

const std::vector<Recipe>& hardRecipes() {
  static const std::vector<Recipe> all{
      {"mug_rim", DepthSense::kStructured, kAcross, mugRim},
      {"toy_muzzle", DepthSense::kStructured, kAcross, toyMuzzle},
      {"box_bare_arm", DepthSense::kFlight, kAcross, boxBareArm},
      {"box_sleeve", DepthSense::kFlight, kAcross, boxSleeve, true},
      {"ball_in_palm", DepthSense::kStructured, kFromAbove, ballInPalm},
      {"cup_takes_ball", DepthSense::kFlight, kAcross, cupTakesBall},
      {"tenth_beside_still", DepthSense::kStructured, kAcross, tenthBesideStill},
      {"small_thing", DepthSense::kFlight, kAcross, smallThing},
      {"flat_front", DepthSense::kRoom8, kAcross, flatFront},
      {"bear_under_hands", DepthSense::kRoom8, kAcross, bearUnderHands},
  };
  return all;
}

}  // namespace hapticast::evaluate::held
