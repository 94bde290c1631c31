// SPDX-License-Identifier: MIT
#include "tests/scenes/held/hand.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::evaluate::held {

namespace {

struct Finger {
  Vec3 base_mm;     // in the hand's frame, right hand
  Vec3 along;       // where it points when it is straight
  Vec3 bends_to;    // where bending takes it
  Vec3 lengths_mm;  // of its three bones
  double thick_mm;  // radius at the base
  double thin_mm;   // and at the tip
};

// An adult's hand: palm 84 mm wide, 190 mm from wrist to fingertip.
const std::array<Finger, 5>& fingers() {
  static const std::array<Finger, 5> all{{
      {{27, -30, 8}, {0.62, 0.35, 0.70}, {-0.55, 0.75, 0.35}, {42, 33, 25}, 11.5, 8.8},
      {{30, 45, 2}, {0.08, 1, 0}, {0, 0, 1}, {45, 27, 20}, 9.4, 7.2},
      {{10, 49, 1}, {0.02, 1, 0}, {0, 0, 1}, {49, 31, 21}, 9.6, 7.3},
      {{-11, 46, 1}, {-0.04, 1, 0}, {0, 0, 1}, {45, 29, 21}, 9.0, 7.0},
      {{-30, 38, 2}, {-0.12, 1, 0}, {0, 0, 1}, {35, 21, 18}, 8.2, 6.3},
  }};
  return all;
}

constexpr double kWristBehind_mm = 58.0;

Vec3 mirrored(const Vec3& v, bool right) { return right ? v : Vec3(-v.x(), v.y(), v.z()); }

// The joints of a finger and the turn of each bone (y along it), in the hand's frame.
struct Chain {
  std::array<Vec3, 4> joint_mm;
  std::array<Mat3, 3> turn;
  std::array<double, 4> radius_mm;
};

Chain chainOf(const HandLook& look, std::size_t number, const std::array<double, 3>& curls) {
  const Finger& finger = fingers()[number];
  const Vec3 along = mirrored(finger.along, look.right).normalized();
  Vec3 bends = mirrored(finger.bends_to, look.right);
  bends = (bends - bends.dot(along) * along).normalized();
  Mat3 frame;
  frame.col(0) = along.cross(bends);
  frame.col(1) = along;
  frame.col(2) = bends;
  Chain out;
  out.joint_mm[0] = look.scale * mirrored(finger.base_mm, look.right);
  double bent = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    bent += curls[i];
    out.turn[i] = frame * Eigen::AngleAxisd(bent, Vec3::UnitX()).toRotationMatrix();
    const double length = look.scale * finger.lengths_mm[static_cast<Eigen::Index>(i)];
    out.joint_mm[i + 1] = out.joint_mm[i] + length * out.turn[i].col(1);
    const double share = double(i) / 3.0;
    out.radius_mm[i] = look.scale * (finger.thick_mm + share * (finger.thin_mm - finger.thick_mm));
  }
  out.radius_mm[3] = look.scale * finger.thin_mm;
  return out;
}

void addPalm(const HandLook& look, Thing& hand) {
  const double s = look.scale;
  const double knuckle_x[] = {27, 9, -10, -28};
  const double knuckle_y[] = {43, 46, 43, 36};
  for (int i = 0; i < 4; ++i) {
    const Vec3 from = s * mirrored({0.62 * knuckle_x[i], -42, -2}, look.right);
    const Vec3 to = s * mirrored({knuckle_x[i], knuckle_y[i], 0}, look.right);
    hand.parts.push_back(makeLimb(from, to, 14.5 * s, 11.0 * s, look.skin, 0));
  }
  hand.parts.push_back(makeLimb(s * mirrored({14, -40, 3}, look.right),
                                s * mirrored({28, -16, 9}, look.right), 15 * s, 12.5 * s, look.skin,
                                0));
}

void addForearm(const HandLook& look, const Vec3& elbow, Thing& hand) {
  const double s = look.scale;
  const Vec3 wrist(0, -kWristBehind_mm * s, -1);
  hand.parts.push_back(makeLimb({0, -34 * s, -1}, wrist, 21 * s, 23 * s, look.skin, 0));
  const Vec3 cuff = wrist + look.sleeve_from * (elbow - wrist);
  hand.parts.push_back(makeLimb(wrist, look.has_sleeve ? cuff : elbow, 23 * s,
                                (look.has_sleeve ? 30 : 43) * s, look.skin, 0));
  if (!look.has_sleeve) return;
  const Vec3 roll = (elbow - wrist).normalized();
  hand.parts.push_back(makeLimb(cuff, elbow, 34 * s, 50 * s, look.sleeve, 6));
  hand.parts.push_back(makeLimb(cuff, cuff + 10.0 * roll, 36 * s, 36 * s, look.sleeve, 6));
}

// How deep the bones from `first` on reach into the thing.
double gapOf_mm(const Thing& thing, const Pose& on_thing, const Chain& chain, std::size_t first) {
  double least = 1e9;
  for (std::size_t i = first; i < 3; ++i) {
    for (const double share : {0.3, 0.65, 1.0}) {
      const Vec3 at = chain.joint_mm[i] + share * (chain.joint_mm[i + 1] - chain.joint_mm[i]);
      const double radius =
          chain.radius_mm[i] + share * (chain.radius_mm[i + 1] - chain.radius_mm[i]);
      const Vec3 on = on_thing.out(at);
      least = std::min(least, distanceTo_mm(thing, on) - radius);
    }
  }
  return least;
}

}  // namespace

Curls openHand() {
  Curls out{};
  out[0] = {-0.45, 0.1, 0.1};
  for (std::size_t i = 1; i < 5; ++i) out[i] = {0.12, 0.22, 0.15};
  return out;
}

Curls between(const Curls& a, const Curls& b, double share) {
  Curls out = a;
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) out[i][k] += share * (b[i][k] - a[i][k]);
  }
  return out;
}

Thing makeHand(std::uint8_t id, const HandLook& look, const Pose& pose, const Curls& curls,
               const Vec3& elbow_mm) {
  Thing hand;
  hand.id = id;
  hand.pose = pose;
  hand.blend_mm = 5.0 * look.scale;
  addPalm(look, hand);
  const Vec3 elbow = pose.in(elbow_mm);
  addForearm(look, elbow, hand);
  for (std::size_t f = 0; f < 5; ++f) {
    const Chain chain = chainOf(look, f, curls[f]);
    for (std::size_t i = 0; i < 3; ++i) {
      Part bone = makeLimb(chain.joint_mm[i], chain.joint_mm[i + 1], chain.radius_mm[i],
                           chain.radius_mm[i + 1], i == 2 ? look.fingertip : look.skin,
                           f == 0 && i == 0 ? 0 : static_cast<int>(7 + f));
      bone.pose.turn = chain.turn[i];
      hand.parts.push_back(bone);
    }
  }
  std::stable_sort(hand.parts.begin(), hand.parts.end(),
                   [](const Part& a, const Part& b) { return a.group < b.group; });
  return hand;
}

Curls closedOn(const Thing& thing, const HandLook& look, const Pose& on_thing) {
  Thing at_origin = thing;
  at_origin.pose = {};
  constexpr double kStep_rad = 0.04;
  const std::array<double, 3> most{1.45, 1.6, 1.1};
  Curls out{};
  for (std::size_t f = 0; f < 5; ++f) {
    out[f] =
        f == 0 ? std::array<double, 3>{-0.7, -0.1, 0.0} : std::array<double, 3>{-0.2, 0.0, 0.0};
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t joint = 0; joint < 3; ++joint) {
        std::array<double, 3> further = out[f];
        further[joint] += kStep_rad;
        if (further[joint] > most[joint]) continue;
        const Chain chain = chainOf(look, f, further);
        const double before = gapOf_mm(at_origin, on_thing, chainOf(look, f, out[f]), joint);
        const double gap = gapOf_mm(at_origin, on_thing, chain, joint);
        if (gap < 0.0 && gap < before) continue;
        out[f] = further;
        moved = true;
      }
    }
  }
  return out;
}

Pinch pinchOf(const HandLook& look, double thickness_mm) {
  Pinch out;
  double least = 1e9;
  out.curls = openHand();
  for (std::size_t f = 2; f < 5; ++f) out.curls[f] = {0.35, 0.5, 0.3};
  // The tips' distance decides, and among equals the fingers that bend less.
  for (double index = 0.2; index < 1.3; index += 0.1) {
    for (double second = 0.2; second < 1.3; second += 0.1) {
      const std::array<double, 3> finger{index, second, 0.4 * second};
      const Chain of_finger = chainOf(look, 1, finger);
      for (double thumb = -0.5; thumb < 1.0; thumb += 0.1) {
        const std::array<double, 3> bent{thumb, 0.3, 0.25};
        const Chain of_thumb = chainOf(look, 0, bent);
        const double gap = (of_finger.joint_mm[3] - of_thumb.joint_mm[3]).norm() -
                           of_finger.radius_mm[3] - of_thumb.radius_mm[3];
        const double cost = std::abs(gap - thickness_mm) + 2.0 * (index + second);
        if (cost >= least) continue;
        least = cost;
        out.curls[0] = bent;
        out.curls[1] = finger;
        out.middle_mm = 0.5 * (of_finger.joint_mm[3] + of_thumb.joint_mm[3]);
      }
    }
  }
  return out;
}

Pose handAt(const Vec3& at_mm, const Vec3& palm, const Vec3& fingers_to) {
  Pose out;
  out.at_mm = at_mm;
  const Vec3 z = palm.normalized();
  const Vec3 y = (fingers_to - fingers_to.dot(z) * z).normalized();
  out.turn.col(0) = y.cross(z);
  out.turn.col(1) = y;
  out.turn.col(2) = z;
  return out;
}

}  // namespace hapticast::evaluate::held
