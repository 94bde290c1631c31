// SPDX-License-Identifier: MIT
#include "tests/scenes/held/solid.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::evaluate::held {

namespace {

// std::hypot guards against overflow, which costs a fifth of the drawing's time.
double length(double a, double b) { return std::sqrt(a * a + b * b); }

constexpr double kHandle_mm = 5.5;     // half thickness of a mug's handle
constexpr double kHandleReach = 0.62;  // its ring's radius, of the mug's half height
constexpr double kMugRounding_mm = 2.5;
constexpr double kStraight = 1e-6;  // 1/mm: a tube bent by less is straight
constexpr double kFurScale = 1.6;   // finer than the noise: tufts of some 4 mm

double roundCone(const Vec3& size_mm, const Vec3& p) {
  const double across = length(p.x(), p.z());
  const double lean = (size_mm.x() - size_mm.z()) / size_mm.y();
  const double upright = std::sqrt(std::max(0.0, 1.0 - lean * lean));
  // Along the cone's side: before its foot it is a ball, beyond its end another.
  const double along = upright * p.y() - lean * across;
  if (along < 0) return length(across, p.y()) - size_mm.x();
  if (along > upright * size_mm.y()) return length(across, p.y() - size_mm.y()) - size_mm.z();
  return upright * across + lean * p.y() - size_mm.x();
}

double ellipsoid(const Vec3& size_mm, const Vec3& p) {
  const Vec3 unit = p.cwiseQuotient(size_mm);
  const double level = unit.norm();
  if (level < 1e-9) return -size_mm.minCoeff();
  return level * (level - 1.0) / unit.cwiseQuotient(size_mm).norm();
}

double box(const Vec3& half_mm, double rounding_mm, const Vec3& p) {
  const Vec3 off = p.cwiseAbs() - half_mm + Vec3::Constant(rounding_mm);
  return off.cwiseMax(0.0).norm() + std::min(0.0, off.maxCoeff()) - rounding_mm;
}

double cylinder(double radius_mm, double half_mm, double rounding_mm, const Vec3& p) {
  const double across = length(p.x(), p.z()) - radius_mm + rounding_mm;
  const double along = std::abs(p.y()) - half_mm + rounding_mm;
  return length(std::max(0.0, across), std::max(0.0, along)) +
         std::min(0.0, std::max(across, along)) - rounding_mm;
}

double mug(const Vec3& size_mm, const Vec3& p) {
  const double radius = size_mm.x();
  const double half = size_mm.y();
  const double wall = size_mm.z();
  const double outer = cylinder(radius, half, kMugRounding_mm, p);
  const double ring = length(p.x() - radius, p.y()) - kHandleReach * half;
  const double handle = length(ring, p.z()) - kHandle_mm;
  const Vec3 up(0, 0.5 * wall + half, 0);
  const double cavity = cylinder(radius - wall, 2.0 * half, 1.0, p - up);
  return std::max(std::min(outer, handle), -cavity);
}

double alongTube(const Vec3& size_mm, const Vec3& p) {
  const double curvature = size_mm.z();
  double along = p.x();
  if (std::abs(curvature) > kStraight) {
    const double sign = curvature > 0 ? 1.0 : -1.0;
    along = std::atan2(p.x(), sign * (1.0 / curvature - p.y())) / std::abs(curvature);
  }
  return std::clamp(along, -size_mm.y(), size_mm.y());
}

double tube(const Vec3& size_mm, const Vec3& p) {
  const double along = alongTube(size_mm, p);
  return (p - placeOnTube(along, size_mm.z()).at_mm).norm() - size_mm.x();
}

// A number in 0..1 that is the same for the same cell.
double chance(int i, int j, int k) {
  std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1U ^
                    static_cast<std::uint32_t>(j) * 0x85EBCA77U ^
                    static_cast<std::uint32_t>(k) * 0xC2B2AE3DU;
  h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
  return static_cast<double>((h ^ (h >> 15U)) >> 8U) / 16777216.0;
}

// Smooth noise with cells of 1, 0..1: one octave, since it is asked for at every step of a ray.
double tuft(const Vec3& p) {
  const Vec3 low(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
  const Vec3 f = p - low;
  const Vec3 w = f.cwiseProduct(f).cwiseProduct(Vec3::Constant(3.0) - 2.0 * f);
  const int i = static_cast<int>(low.x());
  const int j = static_cast<int>(low.y());
  const int k = static_cast<int>(low.z());
  const auto row = [&](int y, int z) {
    const double a = chance(i, y, z);
    return a + w.x() * (chance(i + 1, y, z) - a);
  };
  const double near = row(j, k) + w.y() * (row(j + 1, k) - row(j, k));
  const double far = row(j, k + 1) + w.y() * (row(j + 1, k + 1) - row(j, k + 1));
  return near + w.z() * (far - near);
}

// Two distances flow into one another where they differ by less than `blend`.
double blended(double a, double b, double blend) {
  const double closeness = std::max(0.0, blend - std::abs(a - b));
  return std::min(a, b) - (blend > 0 ? 0.25 * closeness * closeness / blend : 0.0);
}

}  // namespace

Mat3 turnOfY(const Vec3& to) {
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitY(), to).toRotationMatrix();
}

Part makePart(Form form, const Vec3& size_mm, const Vec3& at_mm, std::size_t paint, int group) {
  Part out;
  out.form = form;
  out.size_mm = size_mm;
  out.pose.at_mm = at_mm;
  out.paint = paint;
  out.group = group;
  if (form == Form::kBox || form == Form::kCylinder) out.rounding_mm = std::min(2.0, size_mm.y());
  return out;
}

Part makeLimb(const Vec3& from_mm, const Vec3& to_mm, double radius_mm, double end_radius_mm,
              std::size_t paint, int group) {
  const Vec3 way = to_mm - from_mm;
  Part out =
      makePart(Form::kRoundCone, {radius_mm, way.norm(), end_radius_mm}, from_mm, paint, group);
  out.pose.turn = turnOfY(way);
  return out;
}

TubePlace placeOnTube(double along_mm, double curvature) {
  if (std::abs(curvature) < kStraight) return {{along_mm, 0, 0}, Vec3::UnitY()};
  const double angle = curvature * along_mm;
  return {{std::sin(angle) / curvature, (1.0 - std::cos(angle)) / curvature, 0.0},
          {-std::sin(angle), std::cos(angle), 0.0}};
}

double distanceTo_mm(const Part& part, const Vec3& at_mm) {
  const Vec3& size = part.size_mm;
  switch (part.form) {
    case Form::kRoundCone:
      return roundCone(size, at_mm);
    case Form::kEllipsoid:
      return ellipsoid(size, at_mm);
    case Form::kBox:
      return box(size, part.rounding_mm, at_mm);
    case Form::kCylinder:
      return cylinder(size.x(), size.y(), part.rounding_mm, at_mm);
    case Form::kMug:
      return mug(size, at_mm);
    case Form::kTube:
      return tube(size, at_mm);
  }
  return 1e9;
}

Vec3 textured(const Part& part, const Vec3& at_mm) {
  if (part.form == Form::kEllipsoid) return at_mm.cwiseQuotient(part.squeeze);
  if (part.form != Form::kTube) return at_mm;
  const double along = alongTube(part.size_mm, at_mm);
  const TubePlace place = placeOnTube(along, part.size_mm.z());
  const Vec3 off = at_mm - place.at_mm;
  const Vec3 forward = place.across.cross(Vec3::UnitZ());
  return {along + off.dot(forward), off.dot(place.across), off.z()};
}

Near nearest(const Thing& thing, const Parts& among, const Vec3& at_mm) {
  Near out;
  double nearest_part = 1e9;
  double group_mm = 1e9;
  int group = -1;
  for (const std::uint8_t index : among) {
    const Part& part = thing.parts[index];
    const double distance = distanceTo_mm(part, part.pose.in(at_mm));
    if (part.group != group) {
      out.distance_mm = std::min(out.distance_mm, group_mm);
      group_mm = 1e9;
      group = part.group;
    }
    group_mm = blended(group_mm, distance, thing.blend_mm);
    if (distance >= nearest_part) continue;
    nearest_part = distance;
    out.part = index;
  }
  out.distance_mm = std::min(out.distance_mm, group_mm);
  if (thing.fur_mm > 0 && out.distance_mm < 0.6 * thing.fur_mm)
    out.distance_mm -= thing.fur_mm * (tuft(kFurScale * at_mm) - 0.5);
  return out;
}

double distanceTo_mm(const Thing& thing, const Vec3& at_mm) {
  Parts all(thing.parts.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  return nearest(thing, all, at_mm).distance_mm;
}

Vec3 normalAt(const Thing& thing, const Parts& among, const Vec3& at_mm) {
  constexpr double kStep_mm = 0.2;
  // The corners of a tetrahedron: four looks instead of six.
  const Vec3 corners[] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
  Vec3 sum = Vec3::Zero();
  for (const Vec3& corner : corners)
    sum += corner * nearest(thing, among, at_mm + kStep_mm * corner).distance_mm;
  return sum.normalized();
}

Ball ballAround(const Thing& thing, const Part& part) {
  const Vec3& size = part.size_mm;
  const double room = thing.blend_mm + thing.fur_mm + 0.5;
  const auto around = [&](const Vec3& centre, double radius) {
    return Ball{part.pose.out(centre), radius + room};
  };
  switch (part.form) {
    case Form::kRoundCone:
      return around({0, 0.5 * size.y(), 0}, 0.5 * size.y() + std::max(size.x(), size.z()));
    case Form::kEllipsoid:
      return around(Vec3::Zero(), size.maxCoeff());
    case Form::kBox:
      return around(Vec3::Zero(), size.norm());
    case Form::kCylinder:
      return around(Vec3::Zero(), length(size.x(), size.y()));
    case Form::kMug:
      return around({0.4 * size.y(), 0, 0}, length(size.x(), size.y()) + 0.6 * size.y());
    case Form::kTube:
      return around(Vec3::Zero(), size.y() + size.x());
  }
  return {};
}

}  // namespace hapticast::evaluate::held
