// SPDX-License-Identifier: MIT
#include "tests/scenes/held/reach.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::evaluate::held {

// The pixels that a ball may cover.
cv::Rect rectOf(const Ball& ball, const server::CameraModel& camera, const cv::Size& size) {
  const double nearest_z = ball.centre_mm.z() - ball.radius_mm;
  if (nearest_z < 30.0) return {{0, 0}, size};
  const auto reach = [&](double at, double focal_px, double middle_px, int& low, int& high) {
    const double a = (at - ball.radius_mm) /
                     ((at < ball.radius_mm) ? nearest_z : nearest_z + 2 * ball.radius_mm);
    const double b = (at + ball.radius_mm) /
                     ((at > -ball.radius_mm) ? nearest_z : nearest_z + 2 * ball.radius_mm);
    low = static_cast<int>(std::floor(std::clamp(focal_px * a + middle_px, -1e5, 1e5)));
    high = static_cast<int>(std::ceil(std::clamp(focal_px * b + middle_px, -1e5, 1e5)));
  };
  int left = 0;
  int right = 0;
  int top = 0;
  int bottom = 0;
  reach(ball.centre_mm.x(), camera.fx_px, camera.cx_px, left, right);
  reach(ball.centre_mm.y(), camera.fy_px, camera.cy_px, top, bottom);
  return cv::Rect(left, top, right - left + 1, bottom - top + 1);
}

namespace {

constexpr int kTubeBalls = 12;

// Half edges of the box about a part, in its frame.
Vec3 findBoxAround(const Part& part) {
  const Vec3& size = part.size_mm;
  if (part.form == Form::kCylinder) return {size.x(), size.y(), size.x()};
  if (part.form == Form::kMug) return {size.x() + 0.8 * size.y(), size.y(), size.x()};
  return size;
}

}  // namespace

Reach::Reach(const Thing& thing, const cv::Size& size,
             const std::function<cv::Rect(const Ball&)>& rect_of)
    : thing_(thing) {
  bounds_.reserve(thing.parts.size());
  for (const Part& part : thing.parts) {
    Bound bound;
    const Ball ball = ballAround(thing, part);
    bound.begin_mm = bound.end_mm = ball.centre_mm;
    bound.radius_mm = ball.radius_mm;
    if (part.form == Form::kRoundCone) {
      bound.begin_mm = part.pose.out(Vec3::Zero());
      bound.end_mm = part.pose.out({0, part.size_mm.y(), 0});
      bound.radius_mm -= 0.5 * part.size_mm.y();
    }
    // What two balls, also beyond the picture's border, and the straight hull between them cover
    // lies between what each covers.
    for (const Vec3& end : {bound.begin_mm, bound.end_mm})
      bound.rect |= rect_of({thing.pose.out(end), bound.radius_mm});
    if (part.form == Form::kTube) {  // a chain of balls along it is closer than one about all
      bound.rect = {};
      const double room = ball.radius_mm - part.size_mm.y() + part.size_mm.y() / kTubeBalls;
      for (int i = 0; i < kTubeBalls; ++i) {
        const double share = (2.0 * i + 1.0) / kTubeBalls - 1.0;
        const Vec3 at = placeOnTube(share * part.size_mm.y(), part.size_mm.z()).at_mm;
        bound.chain.push_back({part.pose.out(at), room});
        bound.rect |= rect_of({thing.pose.out(bound.chain.back().centre_mm), room});
      }
    }
    bound.rect &= cv::Rect({0, 0}, size);
    rect_ |= bound.rect;
    bounds_.push_back(bound);
  }
}

Parts Reach::inRow(int v) const {
  Parts out;
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    const cv::Rect& rect = bounds_[i].rect;
    if (v >= rect.y && v < rect.y + rect.height) out.push_back(static_cast<std::uint8_t>(i));
  }
  return out;
}

bool Reach::span(std::size_t index, const Vec3& origin, const Vec3& direction, Span& out) const {
  const Bound& bound = bounds_[index];
  const Part& part = thing_.parts[index];
  if (part.form != Form::kRoundCone && part.form != Form::kTube) {
    // Between the six planes of the box about it, moved out by what flows into it.
    const Vec3 from = part.pose.in(origin);
    const Vec3 way = part.pose.turn.transpose() * direction;
    const Vec3 half = findBoxAround(part) + Vec3::Constant(thing_.blend_mm + thing_.fur_mm + 0.5);
    Span box{-1e12, 1e12};
    for (int axis = 0; axis < 3; ++axis) {
      const double slope = std::abs(way[axis]) < 1e-12 ? 1e-12 : way[axis];
      const double a = (-half[axis] - from[axis]) / slope;
      const double b = (half[axis] - from[axis]) / slope;
      box.from = std::max(box.from, std::min(a, b));
      box.to = std::min(box.to, std::max(a, b));
    }
    if (box.from > box.to || box.to < 0) return false;
    out = box;
    return true;
  }
  if (!bound.chain.empty()) {
    Span chain;
    for (const Ball& ball : bound.chain) {
      const Vec3 to = ball.centre_mm - origin;
      const double along = to.dot(direction) / direction.squaredNorm();
      if ((to - along * direction).squaredNorm() > ball.radius_mm * ball.radius_mm) continue;
      const double room = ball.radius_mm / direction.norm();
      chain = {std::min(chain.from, along - room), std::max(chain.to, along + room)};
    }
    out = chain;
    return chain.to > chain.from;
  }
  // The shortest way between the ray's line and the bound's.
  const double length2 = direction.squaredNorm();
  const auto across = [&](const Vec3& v) {
    return Vec3(v - v.dot(direction) / length2 * direction);
  };
  const Vec3 to_begin = bound.begin_mm - origin;
  const Vec3 side = across(to_begin);
  const Vec3 line = across(bound.end_mm - bound.begin_mm);
  const double line2 = line.squaredNorm();
  const double share = line2 > 0 ? std::clamp(-side.dot(line) / line2, 0.0, 1.0) : 0.0;
  if ((side + share * line).squaredNorm() > bound.radius_mm * bound.radius_mm) return false;
  const double begin = to_begin.dot(direction) / length2;
  const double end = (bound.end_mm - origin).dot(direction) / length2;
  const double room = bound.radius_mm / std::sqrt(length2);
  out = {std::min(begin, end) - room, std::max(begin, end) + room};
  return out.to > 0;
}

Reach::Span Reach::onRay(const Parts& candidates, int u, const Vec3& origin, const Vec3& direction,
                         Parts& out) const {
  out.clear();
  Span all;
  for (const std::uint8_t index : candidates) {
    const cv::Rect& rect = bounds_[index].rect;
    if (u < rect.x || u >= rect.x + rect.width) continue;
    Span one;
    if (!span(index, origin, direction, one)) continue;
    all.from = std::min(all.from, one.from);
    all.to = std::max(all.to, one.to);
    out.push_back(index);
  }
  return all;
}

}  // namespace hapticast::evaluate::held
