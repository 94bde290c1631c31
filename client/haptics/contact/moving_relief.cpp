// SPDX-License-Identifier: MIT
#include "client/haptics/contact/moving_relief.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::client {

namespace {

// Bound on the distance by which the blurred edge exceeds the mask's rectangle.
constexpr double kRim_px = 3.0;

/// Returns a gradient, turned from the frame's axes to the object's axes.
Vec2 rotateBack(const Vec2& turn, const Vec2& gradient) noexcept {
  return {turn.x() * gradient.x() + turn.y() * gradient.y(),
          turn.x() * gradient.y() - turn.y() * gradient.x()};
}

}  // namespace

bool MovingRelief::Frame::isSame(const PlayObject& object) const noexcept {
  return field == object.field && position_mm == object.motion.position_mm &&
         angle_rad == object.motion.angle_rad;
}

void MovingRelief::Frame::set(const PlayObject& object, const Workspace& workspace) noexcept {
  field = object.field;
  position_mm = object.motion.position_mm;
  angle_rad = object.motion.angle_rad;
  rotation_rad = angle_rad == 0.0 ? Vec2(1.0, 0.0) : Vec2(std::cos(angle_rad), std::sin(angle_rad));
  origin_px = workspace.toImage(position_mm.head<2>());
  const Vec2 mm = workspace.mmPerPixel();
  u = Vec2(rotation_rad.x(), -rotation_rad.y()) / mm.x();
  v = Vec2(-rotation_rad.y(), -rotation_rad.x()) / mm.y();
}

BlendedHeight MovingRelief::Frame::height(const Vec2& q_mm) const noexcept {
  const CurvedSample at = field->spline(toImage(q_mm));
  const double c = rotation_rad.x();
  const double s = rotation_rad.y();
  const double mixed = 2.0 * c * s * at.bend_xy;
  return {at.height_mm - position_mm.z(), rotateBack(rotation_rad, at.gradient),
          c * c * at.bend_xx + s * s * at.bend_yy + mixed,
          (c * c - s * s) * at.bend_xy + c * s * (at.bend_yy - at.bend_xx),
          s * s * at.bend_xx + c * c * at.bend_yy - mixed};
}

EdgeSample MovingRelief::Frame::edge(const Vec2& q_mm) const noexcept {
  const EdgeSample at = field->edge(toImage(q_mm));
  return {at.distance_mm, rotateBack(rotation_rad, at.gradient)};
}

bool MovingRelief::Frame::isAside(const Vec2& a_mm, const Vec2& b_mm) const noexcept {
  const Vec2 a = toImage(a_mm);
  const Vec2 b = toImage(b_mm);
  const PixelRect& rect = field->rect();
  return std::max(a.x(), b.x()) < rect.u - kRim_px || std::max(a.y(), b.y()) < rect.v - kRim_px ||
         std::min(a.x(), b.x()) > rect.u + rect.width + kRim_px ||
         std::min(a.y(), b.y()) > rect.v + rect.height + kRim_px;
}

bool MovingRelief::update(const InterpolatedObject& object, const Workspace& workspace) noexcept {
  const PlayObject* first = object.before;
  const PlayObject* second = shows(object.after) ? object.after : nullptr;
  if (second != nullptr && isSameRelief(*first, *second)) second = nullptr;
  // At either end of the interval one frame is enough, unless the blend has a rate.
  const bool still = object.blend_rate_1_s == 0.0;
  if (second != nullptr && still && object.blend >= 1.0) first = second;
  if (still && (object.blend <= 0.0 || object.blend >= 1.0)) second = nullptr;
  blend_ = second != nullptr ? object.blend : 0.0;
  blend_rate_1_s_ = second != nullptr ? object.blend_rate_1_s : 0.0;
  const bool two = second != nullptr;
  if (first_.isSame(*first) && two == two_ && (!two || second_.isSame(*second))) return false;
  first_.set(*first, workspace);
  two_ = two;
  highest_mm_ = first_.field->highest_mm() - first_.position_mm.z();
  if (two) {
    second_.set(*second, workspace);
    highest_mm_ = std::max(highest_mm_, second_.field->highest_mm() - second_.position_mm.z());
  }
  pixel_mm_ = workspace.mmPerPixel().minCoeff();
  return true;
}

MovingRelief::Heights MovingRelief::heights(const Vec2& q_mm) const noexcept {
  Heights pair;
  pair.first = first_.height(q_mm);
  if (two_) pair.second = second_.height(q_mm);
  return pair;
}

MovingRelief::Edges MovingRelief::edges(const Vec2& q_mm) const noexcept {
  Edges pair;
  pair.first = first_.edge(q_mm);
  if (two_) pair.second = second_.edge(q_mm);
  return pair;
}

BlendedHeight MovingRelief::now(const Heights& pair) const noexcept {
  if (!two_) return pair.first;
  const auto blended = [this](double a, double b) { return a + blend_ * (b - a); };
  const auto& [a, b] = pair;
  return {blended(a.height_mm, b.height_mm), a.gradient + blend_ * (b.gradient - a.gradient),
          blended(a.bend_xx, b.bend_xx), blended(a.bend_xy, b.bend_xy),
          blended(a.bend_yy, b.bend_yy)};
}

EdgeSample MovingRelief::now(const Edges& pair) const noexcept {
  if (!two_) return pair.first;
  const auto& [a, b] = pair;
  return {a.distance_mm + blend_ * (b.distance_mm - a.distance_mm),
          a.gradient + blend_ * (b.gradient - a.gradient)};
}

double MovingRelief::rate_mm_s(const Heights& pair) const noexcept {
  return two_ ? (pair.second.height_mm - pair.first.height_mm) * blend_rate_1_s_ : 0.0;
}

double MovingRelief::rate_mm_s(const Edges& pair) const noexcept {
  return two_ ? (pair.second.distance_mm - pair.first.distance_mm) * blend_rate_1_s_ : 0.0;
}

bool MovingRelief::isAside(const Vec2& a_mm, const Vec2& b_mm) const noexcept {
  return first_.isAside(a_mm, b_mm) && (!two_ || second_.isAside(a_mm, b_mm));
}

}  // namespace hapticast::client
