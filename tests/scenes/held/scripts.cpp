// SPDX-License-Identifier: MIT
// Scripts of the scenes of held things, in the table's frame (x right, y up, z to the
// viewer), then placed before the camera.
#include <cmath>

#include "tests/scenes/held/recipe.hpp"

namespace hapticast::evaluate::held {

namespace {

using On = Station::On;

constexpr double kSlant = 0.15;

void mugTurned(Play& p) {
  p.object(Kind::kMug, p.at(0, 95, 0), -2.3);
  p.way().move({0.3, 1.2}, p.at(-25, 30, 30)).move({1.3, 2.1}, p.at(40, -25, -20));
  p.swing({0.4, 1.3}, {0, 1, 0.2}, 0.6);
  p.swing({1.2, 2.1}, {0.3, -0.6, 1}, 0.5);
  p.finishObject();
  holdThroughout(p, p.hand(kHand, true, viewersElbow(p)),
                 p.gripFrom(p.at(1, 0, 0.1), 40, p.at(0, kSlant, -1)));
}

void mugSkin(Play& p) {
  mugTurned(p);
  Paint& paint = p.scene.paints[p.scene.object.paint];
  paint.pattern = Pattern::kPlain;
  paint.color = 0.92F * p.scene.paints[p.skin].color;
}

void lifted(Play& p, double distance_mm, const Vec3& from, const Vec3& fingers, const Vec3& elbow) {
  p.way().move({0.95, 1.35}, p.at(-20, 95, 15)).move({1.5, 1.85}, p.at(45, -95, -5));
  p.swing({0.95, 1.8}, {0, 1, 0}, 0.35);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, elbow);
  const Pose grip = p.gripFrom(from, distance_mm, fingers);
  p.close(hand, grip);
  const Vec3 away = 260.0 * from.normalized() + p.at(40, 70, 60);
  hand.stations = {p.off(0.2, grip, 0.0, away), Play::on(0.65, grip, 0),
                   Play::on(0.85, grip, 1),     Play::on(1.87, grip, 1),
                   Play::on(1.97, grip, 0),     p.off(2.3, grip, 1.9, away)};
  p.scene.hands = {hand};
}

void mugLifted(Play& p) {
  p.object(Kind::kMug, p.at(0, 47, 0), -2.0);
  lifted(p, 40, p.at(1, 0, 0.3), p.at(-0.2, kSlant, -1), viewersElbow(p));
}

void bottleLifted(Play& p) {
  p.object(Kind::kBottle, p.at(10, 62, -20), 0.4);
  lifted(p, 33, p.at(1, 0.1, -0.1), p.at(0, 0.1, 1), personsElbow(p));
  p.scene.hands[0].look.right = !p.scene.hands[0].look.right;
  p.close(p.scene.hands[0], p.scene.hands[0].stations[1].pose);
}

void bearTouched(Play& p) {
  p.object(Kind::kBear, p.at(0, 52, 0), 0.25);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, viewersElbow(p));
  const Pose grip = p.gripFrom(p.at(0.25, 1, 0.05), 108, p.at(-1, 0.1, -0.4));
  p.close(hand, grip);
  const Vec3 away = p.at(220, 90, 120);
  hand.stations = {p.off(0.2, grip, 0, away), Play::on(0.7, grip, 0.8), Play::on(1.4, grip, 0.8),
                   p.off(2.1, grip, 0, away)};
  p.scene.hands = {hand};
}

void bearRested(Play& p) {
  p.object(Kind::kBear, p.at(0, 52, 0), -0.2);
  p.finishObject();
  holdThroughout(p, p.hand(kHand, false, p.at(-240, 60, -330)),
                 p.gripFrom(p.at(-0.55, 0.85, -0.1), 96, p.at(0.7, 0.5, 0.6)), 0.9);
}

void bearCarried(Play& p) {
  p.object(Kind::kBear, p.at(0, 100, 0), 0.1);
  p.way().move({0.2, 0.9}, p.at(60, 40, 40)).move({1.0, 1.9}, p.at(-110, -20, -30));
  p.swing({0.4, 1.2}, {0, 1, 0}, 0.6);
  p.swing({1.1, 2.0}, {0, 0.2, 1}, -0.45);
  p.finishObject();
  holdThroughout(p, p.hand(kHand, false, p.at(240, 60, -330)),
                 p.gripFrom(p.at(1, 0.05, -0.35), 44, p.at(0.1, 0.1, 1)));
}

void ballSqueezed(Play& p) {
  p.object(Kind::kBall, p.at(0, 90, 0), 0.0);
  p.scene.object.bent.step({0.4, 0.75}, 0.26).step({0.9, 1.2}, -0.26);
  p.scene.object.bent.step({1.35, 1.7}, 0.3).step({1.8, 2.15}, -0.24);
  p.way().move({0.8, 1.6}, p.at(30, 15, 20));
  p.finishObject();
  holdThroughout(p, p.hand(kHand, true, viewersElbow(p)),
                 p.gripFrom(p.at(1, 0, 0), 48, p.at(0, 0.3, -1)), 1, p.mirror * Vec3(48, 0, 0));
}

void handedOver(Play& p, double right_mm, double left_mm) {
  p.way().move({0.2, 0.8}, p.at(-60, 10, 10)).move({1.5, 2.2}, p.at(-90, 25, -10));
  p.swing({1.5, 2.2}, {0, 1, 0}, 0.4);
  p.finishObject();
  HandScript giver = p.hand(kHand, true, viewersElbow(p));
  const Pose grip = p.gripFrom(p.at(1, 0, 0.1), right_mm, p.at(0, kSlant, -1));
  p.close(giver, grip);
  giver.stations = {Play::on(0, grip, 1), Play::on(1.25, grip, 1), Play::on(1.4, grip, 0),
                    p.off(1.95, grip, 1.4, p.at(260, 20, 90))};
  HandScript taker = p.hand(kOtherHand, true, p.at(-240, 60, -330));
  const Pose other = p.gripFrom(p.at(-1, 0, -0.1), left_mm, p.at(0, 0.1, 1));
  p.close(taker, other);
  taker.stations = {p.off(0.4, other, 0.8, p.at(-230, 10, -60)), Play::on(1.0, other, 0),
                    Play::on(1.2, other, 1), Play::on(9, other, 1)};
  p.scene.hands = {giver, taker};
  p.scene.held_at_start = true;
}

void boxHandedOver(Play& p) {
  p.object(Kind::kBox, p.at(20, 95, 0), 0.15);
  handedOver(p, 48, 48);
}

void ballHandedOver(Play& p) {
  p.object(Kind::kBall, p.at(20, 90, 0), 0.3);
  handedOver(p, 48, 48);
}

void tubeBent(Play& p) {
  p.object(Kind::kTube, p.at(0, 95, 0), 0.0);
  p.scene.object.bent.step({0.3, 1.1}, 0.0058).step({1.3, 2.1}, -0.0075);
  p.way().move({0.5, 1.5}, p.at(15, -20, 20));
  p.finishObject();
  for (const bool right : {true, false}) {
    const double x = right ? 1.0 : -1.0;
    HandScript hand = p.hand(right ? kHand : kOtherHand, right, p.at(x * 330, -20, 330));
    const Vec3 anchor(p.mirror * x * 128, 0, 0);
    Pose grip = p.gripFrom(p.at(x * 0.3, -0.5, 0.75), 24, p.at(-0.1 * x, 0.75, 0.4));
    grip.at_mm += anchor;
    holdThroughout(p, hand, grip, 1, anchor);
  }
}

void passedBy(Play& p) {
  p.object(Kind::kBottle, p.at(0, 62, -40), 0.6);
  p.finishObject();
  HandScript hand = p.hand(kHand, true, p.at(330, 60, 380));
  const auto station = [&](double t, double x, double y) {
    return Station{t, On::kScene,
                   p.inScene(handAt(p.at(x, y, 95), p.at(-0.2, -0.3, -1), p.at(-1, 0.25, 0))), 0.0,
                   Vec3::Zero()};
  };
  hand.elbow_follows = 0.8;
  hand.stations = {station(0.3, 330, 70), station(1.05, -30, 90), station(1.25, -40, 92),
                   station(2.1, 340, 60)};
  p.scene.hands = {hand};
}

void hiddenByBook(Play& p) {
  p.object(Kind::kBall, p.at(0, 48, -20), 0.7);
  p.finishObject();
  const Paint cover{Pattern::kLabel, anyColor(p.draw), anyColor(p.draw), 30.0, 0.1F, 0.0F};
  Thing book;
  book.id = kOther;
  Part board;
  board.form = Form::kBox;
  board.size_mm = {105, 135, 9};
  board.rounding_mm = 2.0;
  board.paint = p.add(cover);
  book.parts = {board};
  Path way({Mat3::Identity(), p.at(400, 90, 110)});
  way.move({0.2, 0.95}, p.at(-400, 0, 0)).move({1.0, 1.8}, p.at(410, 10, 0));
  p.scene.props = {{book, way.in(p.to_camera)}};
  HandScript hand = p.hand(kHand, true, p.at(620, 20, 300));
  const Pose grip = handAt(p.at(112, -30, -22), p.at(-0.25, 0, 1), p.at(-1, 0.2, 0));
  hand.elbow_follows = 0.9;
  hand.grip = openHand();
  hand.stations = {{0, On::kProp, grip, 1, Vec3::Zero()}, {9, On::kProp, grip, 1, Vec3::Zero()}};
  p.scene.hands = {hand};
}

void boxGloved(Play& p) {
  p.object(Kind::kBox, p.at(0, 62, 0), 0.2);
  Paint glove = p.scene.paints[p.scene.object.paint];
  glove.pattern = Pattern::kPlain;
  glove.gloss = 0.15F;
  const std::size_t paint = p.add(glove);
  lifted(p, 48, p.at(1, 0, 0.15), p.at(-0.1, kSlant, -1), viewersElbow(p));
  p.scene.hands[0].look.skin = p.scene.hands[0].look.fingertip = paint;
}

void ballStill(Play& p) {
  p.object(Kind::kBall, p.at(0, 85, 0), 0.5);
  p.finishObject();
  holdThroughout(p, p.hand(kHand, true, viewersElbow(p)),
                 p.gripFrom(p.at(0.8, -0.6, 0.2), 48, p.at(-0.3, 0.1, -1)));
}

void bottleTurned(Play& p) {
  p.object(Kind::kBottle, p.at(0, 100, 0), 0.0, 0.95);
  p.way().move({0.2, 1.0}, p.at(40, 30, 30)).move({1.0, 2.0}, p.at(-70, -20, -40));
  p.swing({0.4, 1.2}, {0, 0.3, 1}, 0.5);
  p.swing({1.2, 2.1}, {0.5, 0.5, -1}, 0.5);
  p.finishObject();
  holdThroughout(p, p.hand(kHand, false, personsElbow(p)),
                 p.gripFrom(p.at(1, 0.1, -0.2), 32, p.at(0, 0.1, 1)));
}

}  // namespace

const std::vector<Recipe>& firstRecipes() {
  static const std::vector<Recipe> all{
      {"mug_turned", DepthSense::kStructured, kAcross, mugTurned},
      {"mug_skin", DepthSense::kFlight, kOverhead, mugSkin},
      {"mug_lifted", DepthSense::kFlight, kAcross, mugLifted},
      {"bottle_lifted", DepthSense::kStructured, kAcross, bottleLifted},
      {"bear_touched", DepthSense::kStructured, kAcross, bearTouched},
      {"bear_rested", DepthSense::kFlight, kAcross, bearRested},
      {"bear_carried", DepthSense::kRoom8, kAcross, bearCarried},
      {"ball_squeezed", DepthSense::kStructured, kAcross, ballSqueezed},
      {"box_handed_over", DepthSense::kStructured, kAcross, boxHandedOver},
      {"ball_handed_over", DepthSense::kFlight, kOverhead, ballHandedOver},
      {"tube_bent", DepthSense::kFlight, kAcross, tubeBent},
      {"bottle_passed", DepthSense::kRoom8, kAcross, passedBy},
      {"ball_hidden", DepthSense::kStructured, kAcross, hiddenByBook},
      {"box_gloved", DepthSense::kFlight, kOverhead, boxGloved},
      {"ball_still", DepthSense::kEstimate8, kAcross, ballStill},
      {"bottle_turned", DepthSense::kEstimate16, kAcross, bottleTurned},
  };
  return all;
}

}  // namespace hapticast::evaluate::held
