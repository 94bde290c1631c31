// SPDX-License-Identifier: MIT
#include "tests/scenes/held/objects.hpp"

#include <cmath>

namespace hapticast::evaluate::held {

namespace {

constexpr std::uint8_t kObjectId = 1;
constexpr double kTubeHalf_mm = 165.0;
constexpr double kNearlyStraight = 1e-5;  // 1/mm: below, the series of the tube's motion is used

// A sitting bear: body, head with muzzle, ears, arms, legs. Paints: fur, muzzle and belly, nose and
// eyes.
void addBear(double s, std::size_t paint, Thing& bear) {
  const auto ball = [&](const Vec3& size, const Vec3& at, std::size_t of, int group) {
    bear.parts.push_back(makePart(Form::kEllipsoid, s * size, s * at, paint + of, group));
  };
  ball({46, 52, 40}, {0, 0, 0}, 0, 0);
  ball({34, 36, 16}, {0, -4, 28}, 1, 0);
  ball({41, 37, 37}, {0, 76, 4}, 0, 0);
  ball({20, 15, 17}, {0, 68, 34}, 1, 0);
  ball({14, 14, 8}, {-32, 106, 0}, 0, 0);
  ball({14, 14, 8}, {32, 106, 0}, 0, 0);
  bear.parts.push_back(
      makeLimb(s * Vec3(-38, 30, 4), s * Vec3(-62, -8, 26), 16 * s, 17 * s, paint));
  bear.parts.push_back(makeLimb(s * Vec3(38, 30, 4), s * Vec3(62, -8, 26), 16 * s, 17 * s, paint));
  bear.parts.push_back(
      makeLimb(s * Vec3(-28, -34, 10), s * Vec3(-46, -38, 62), 21 * s, 20 * s, paint));
  bear.parts.push_back(
      makeLimb(s * Vec3(28, -34, 10), s * Vec3(46, -38, 62), 21 * s, 20 * s, paint));
  ball({17, 17, 6}, {-46, -37, 80}, 1, 0);
  ball({17, 17, 6}, {46, -37, 80}, 1, 0);
  ball({7, 5, 5}, {0, 74, 50}, 2, 1);
  ball({4.5, 4.5, 4}, {-15, 87, 34}, 2, 1);
  ball({4.5, 4.5, 4}, {15, 87, 34}, 2, 1);
  bear.blend_mm = 9.0 * s;
  bear.fur_mm = 1.3;
}

void addBottle(double s, std::size_t paint, Thing& bottle) {
  Part body = makePart(Form::kCylinder, s * Vec3(33, 62, 0), Vec3::Zero(), paint);
  body.rounding_mm = 6.0 * s;
  bottle.parts.push_back(body);
  bottle.parts.push_back(
      makePart(Form::kRoundCone, s * Vec3(27, 46, 12), s * Vec3(0, 52, 0), paint + 1));
  Part neck = makePart(Form::kCylinder, s * Vec3(12.5, 22, 0), s * Vec3(0, 112, 0), paint + 1);
  neck.rounding_mm = 2.0 * s;
  bottle.parts.push_back(neck);
  Part cap = makePart(Form::kCylinder, s * Vec3(15.5, 11, 0), s * Vec3(0, 132, 0), paint + 2, 1);
  cap.rounding_mm = 2.0 * s;
  bottle.parts.push_back(cap);
  bottle.blend_mm = 7.0 * s;
}

Vec3 squeezedBy(double share) {
  const double along = 1.0 - share;
  const double across = 1.0 / std::sqrt(along);  // its volume stays
  return {along, across, across};
}

// How fast a place `along` the tube and its direction across move per change of curvature.
TubePlace placePerCurvature(double along, double curvature) {
  const double angle = curvature * along;
  TubePlace out;
  if (std::abs(curvature) < kNearlyStraight) {
    out.at_mm = {-curvature * along * along * along / 3.0, 0.5 * along * along, 0.0};
  } else {
    const double k2 = curvature * curvature;
    out.at_mm = {(angle * std::cos(angle) - std::sin(angle)) / k2,
                 (angle * std::sin(angle) - (1.0 - std::cos(angle))) / k2, 0.0};
  }
  out.across = along * Vec3(-std::cos(angle), -std::sin(angle), 0.0);
  return out;
}

}  // namespace

Thing Object::at(double t) const {
  Thing out;
  out.id = kObjectId;
  out.pose = path.at(t).pose;
  switch (kind) {
    case Kind::kMug:
      out.parts.push_back(makePart(Form::kMug, size * Vec3(40, 47, 3.5), Vec3::Zero(), paint));
      break;
    case Kind::kBear:
      addBear(size, paint, out);
      break;
    case Kind::kBall: {
      const Vec3 squeeze = squeezedBy(bent.at(t));
      out.parts.push_back(makePart(Form::kEllipsoid, 48.0 * size * squeeze, Vec3::Zero(), paint));
      out.parts.back().squeeze = squeeze;
      break;
    }
    case Kind::kBox:
      out.parts.push_back(makePart(Form::kBox, size * Vec3(48, 62, 30), Vec3::Zero(), paint));
      out.parts.back().rounding_mm = 2.5;
      break;
    case Kind::kTablet:
      out.parts.push_back(makePart(Form::kBox, size * Vec3(84, 58, 5), Vec3::Zero(), paint));
      out.parts.back().rounding_mm = 3.0;
      break;
    case Kind::kTube:
      out.parts.push_back(makePart(Form::kTube, {24.0 * size, kTubeHalf_mm * size, bent.at(t)},
                                   Vec3::Zero(), paint));
      break;
    case Kind::kBottle:
      addBottle(size, paint, out);
      break;
  }
  return out;
}

Vec3 Object::placed(const Vec3& unbent_mm, double t) const {
  if (kind == Kind::kBall) return squeezedBy(bent.at(t)).cwiseProduct(unbent_mm);
  if (kind != Kind::kTube) return unbent_mm;
  const TubePlace place = placeOnTube(unbent_mm.x(), bent.at(t));
  return place.at_mm + unbent_mm.y() * place.across + unbent_mm.z() * Vec3::UnitZ();
}

Mat3 Object::turned(const Vec3& unbent_mm, double t) const {
  if (kind != Kind::kTube) return Mat3::Identity();
  return Eigen::AngleAxisd(bent.at(t) * unbent_mm.x(), Vec3::UnitZ()).toRotationMatrix();
}

Vec3 Object::velocityAt(const Vec3& at_mm, double t) const {
  const MotionState state = path.at(t);
  Vec3 rigid = state.velocityAt(at_mm);
  const double rate = bent.rate(t);
  if (rate == 0.0) return rigid;
  const Vec3 inner = state.pose.in(at_mm);
  if (kind == Kind::kBall) {
    const double left = 1.0 - bent.at(t);
    const Vec3 stretching = rate / left * Vec3(-1.0, 0.5, 0.5);
    return rigid + state.pose.turn * stretching.cwiseProduct(inner);
  }
  if (kind != Kind::kTube) return rigid;
  const Vec3 unbent = textured(at(t).parts.front(), inner);
  // The round ends keep their shape: they move with the tube's last place.
  const double half_mm = at(t).parts.front().size_mm.y();
  const double along = std::fmax(-half_mm, std::fmin(half_mm, unbent.x()));
  const TubePlace per = placePerCurvature(along, bent.at(t));
  const Vec3 forward(per.across.y(), -per.across.x(), 0.0);
  const Vec3 moved = per.at_mm + unbent.y() * per.across + (unbent.x() - along) * forward;
  return rigid + state.pose.turn * (rate * moved);
}

}  // namespace hapticast::evaluate::held
