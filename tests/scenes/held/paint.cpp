// SPDX-License-Identifier: MIT
#include "tests/scenes/held/paint.hpp"

#include <algorithm>
#include <cmath>

#include "server/source/synthetic/synthetic_scene.hpp"

namespace hapticast::evaluate::held {

namespace {

float smoothStep(double from, double to, double at) {
  const double share = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return static_cast<float>(share * share * (3.0 - 2.0 * share));
}

Color mixed(const Color& a, const Color& b, float share) { return a + share * (b - a); }

double wrapped(double at, double period) { return at - period * std::floor(at / period); }

// A number in 0..1 that is the same for the same cell.
float drawn(int i, int j, int k = 0) {
  std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1U ^
                    static_cast<std::uint32_t>(j) * 0x85EBCA77U ^
                    static_cast<std::uint32_t>(k) * 0xC2B2AE3DU;
  h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12U)) * 0x297A2D39U;
  return static_cast<float>((h ^ (h >> 15U)) >> 8U) / 16777216.0F;
}

Color checks(const Paint& paint, const Vec3& p) {
  const double x = wrapped(p.x(), paint.scale_mm) / paint.scale_mm;
  const double y = wrapped(p.y(), paint.scale_mm) / paint.scale_mm;
  const float bars = 0.5F * (x < 0.4 ? 1.0F : 0.0F) + 0.5F * (y < 0.4 ? 1.0F : 0.0F);
  return mixed(paint.color, paint.second, bars);
}

Color label(const Paint& paint, const Vec3& p) {
  if (std::abs(p.y()) > paint.scale_mm) return paint.color;
  const double around_mm = std::atan2(p.z(), p.x()) * 33.0;
  const int row = static_cast<int>(std::floor(p.y() / 7.0));
  const double letter = wrapped(around_mm, 5.0);
  const bool ink = wrapped(p.y(), 7.0) < 3.5 && letter < 3.4 &&
                   drawn(row, static_cast<int>(std::floor(around_mm / 5.0))) < 0.6F;
  return ink ? Color(0.08F, 0.08F, 0.08F) : paint.second;
}

Color shelf(const Paint& paint, const Vec3& p) {
  const double height_mm = 11.0 * paint.scale_mm;
  const int row = static_cast<int>(std::floor(p.y() / height_mm));
  const double up = wrapped(p.y(), height_mm) / height_mm;
  const int book = static_cast<int>(std::floor(p.x() / paint.scale_mm + 0.4 * drawn(row, 3)));
  if (up < 0.07) return paint.color;
  if (up > 0.68 + 0.26F * drawn(book, row, 1)) return 0.25F * paint.color;
  const Color back(0.06F + 0.4F * drawn(book, row, 2), 0.06F + 0.4F * drawn(book, row, 3),
                   0.08F + 0.5F * drawn(book, row, 4));
  return wrapped(up * 9.0 + drawn(book, row, 5), 3.0) < 0.4 ? mixed(back, paint.second, 0.5F)
                                                            : back;
}

Color dots(const Paint& paint, const Vec3& p) {
  const double s = paint.scale_mm;
  const Vec3 cell(std::floor(p.x() / s), std::floor(p.y() / s), std::floor(p.z() / s));
  const double off = (p / s - cell - Vec3::Constant(0.5)).norm();
  return mixed(paint.second, paint.color, smoothStep(0.36, 0.42, off));
}

// Each patch is some 30 mm wide.
Color patches(const Paint& paint, const Vec3& p) {
  const Color white(0.72F, 0.78F, 0.8F);
  const double where = solidNoise(0.22 * p + Vec3(35, 60, 20));
  const Color first = mixed(paint.color, white, smoothStep(0.45, 0.47, where));
  return mixed(first, paint.second, smoothStep(0.54, 0.56, where));
}

// The wall of a mug lies beyond this radius.
bool inRim(const Paint& paint, const Vec3& p) {
  constexpr double kInside_mm = 38.0;
  return p.y() > paint.scale_mm || std::sqrt(p.x() * p.x() + p.z() * p.z()) < kInside_mm;
}

Color skin(const Paint& paint, const Vec3& p, float uneven) {
  const Color red(0.75F * paint.color.x(), 0.8F * paint.color.y(), 1.0F * paint.color.z());
  const float blotch = static_cast<float>(solidNoise(0.35 * p + Vec3(90, 40, 10)));
  return mixed(paint.color, red, std::clamp(2.5F * (blotch - 0.35F), 0.0F, 1.0F)) *
         (0.9F + 0.2F * uneven);
}

}  // namespace

double solidNoise(const Vec3& at_mm) {
  static const server::SolidNoise noise;
  return double(noise.at(at_mm));
}

Color colorAt(const Paint& paint, const Vec3& p) {
  const auto noise = static_cast<float>(solidNoise(p));
  const float uneven = 0.88F + 0.24F * noise;
  switch (paint.pattern) {
    case Pattern::kPlain:
      return paint.color * uneven;
    case Pattern::kBlotches:
      return mixed(paint.color, paint.second, smoothStep(0.42, 0.58, double(noise)));
    case Pattern::kStripes: {
      const double at = wrapped(p.y() + 2.0 * double(noise), paint.scale_mm) / paint.scale_mm;
      return (at < 0.5 ? paint.color : paint.second) * uneven;
    }
    case Pattern::kChecks:
      return checks(paint, p) * uneven;
    case Pattern::kFur: {
      const auto tuft = static_cast<float>(solidNoise(1.6 * p));
      return mixed(paint.second, paint.color, std::clamp(1.8F * tuft - 0.3F, 0.0F, 1.0F)) * uneven;
    }
    case Pattern::kSkin:
      return skin(paint, p, noise);
    case Pattern::kFingertip: {
      const bool nail = p.z() < -5.2 && std::abs(p.x()) < 4.6 && p.y() > 8.0;
      const Color under = skin(paint, p, noise);
      return nail ? mixed(under, Color(0.62F, 0.66F, 0.85F), 0.5F) : under;
    }
    case Pattern::kWood: {
      const Vec3 along(0.06 * p.x(), p.y(), p.z());
      const auto grain = static_cast<float>(solidNoise(0.9 * along));
      return mixed(paint.color, paint.second, smoothStep(0.3, 0.7, double(grain))) *
             (0.94F + 0.12F * noise);
    }
    case Pattern::kDots:
      return dots(paint, p) * uneven;
    case Pattern::kLabel:
      return label(paint, p) * uneven;
    case Pattern::kRim:
      return (inRim(paint, p) ? paint.second : paint.color) * uneven;
    case Pattern::kPatches:
      return patches(paint, p) * uneven;
    case Pattern::kShelf:
      return shelf(paint, p) * uneven;
  }
  return paint.color;
}

bool holeAt(const Paint& paint, const Vec3& at_mm) {
  if (paint.holes <= 0.0F) return false;
  // The noise lies between .2 and .8 nearly everywhere.
  return solidNoise(0.7 * at_mm + Vec3(11, 47, 83)) < 0.25 + 0.5 * double(paint.holes);
}

}  // namespace hapticast::evaluate::held
