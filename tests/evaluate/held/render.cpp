// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace hapticast::evaluate::held {

namespace {

constexpr int kSteps = 96;          // rays that graze take many
constexpr double kClose_mm = 0.02;  // from here on the root is refined
constexpr double kCautious = 0.85;  // of an ellipsoid's distance, which is not quite a bound
constexpr int kShadowMap = 288;
constexpr double kShadowCell_mm = 3.0;
constexpr double kShadowBias_mm = 7.0;
constexpr float kNowhere = 1e9F;

struct Bounds {
  cv::Rect rect;
  Ball ball;  // in the thing's frame
};

// The pixels that a ball may cover.
cv::Rect rectOf(const Ball& ball, const server::CameraModel& camera, const cv::Size& size) {
  const double nearest_z = ball.centre_mm.z() - ball.radius_mm;
  const cv::Rect all({0, 0}, size);
  if (nearest_z < 30.0) return ball.centre_mm.z() + ball.radius_mm < 1.0 ? cv::Rect() : all;
  const auto reach = [&](double at, double focal_px, double middle_px, int& low, int& high) {
    const double a = (at - ball.radius_mm) /
                     ((at < ball.radius_mm) ? nearest_z : nearest_z + 2 * ball.radius_mm);
    const double b = (at + ball.radius_mm) /
                     ((at > -ball.radius_mm) ? nearest_z : nearest_z + 2 * ball.radius_mm);
    low = static_cast<int>(std::floor(std::clamp(focal_px * a + middle_px, -10.0, 1e5)));
    high = static_cast<int>(std::ceil(std::clamp(focal_px * b + middle_px, -10.0, 1e5)));
  };
  int left = 0;
  int right = 0;
  int top = 0;
  int bottom = 0;
  reach(ball.centre_mm.x(), camera.fx_px, camera.cx_px, left, right);
  reach(ball.centre_mm.y(), camera.fy_px, camera.cy_px, top, bottom);
  return cv::Rect(left, top, right - left + 1, bottom - top + 1) & all;
}

// Of the candidates, those whose balls the ray meets, and between where.
struct Span {
  double from = std::numeric_limits<double>::infinity();
  double to = 0.0;
};
Span among(const std::vector<Bounds>& bounds, const Parts& candidates, int u, const Vec3& origin,
           const Vec3& direction, Parts& out) {
  out.clear();
  Span span;
  const double length2 = direction.squaredNorm();
  for (const std::uint8_t index : candidates) {
    const Bounds& b = bounds[index];
    if (u < b.rect.x || u >= b.rect.x + b.rect.width) continue;
    const Vec3 to = b.ball.centre_mm - origin;
    const double along = to.dot(direction) / length2;
    const double rest =
        b.ball.radius_mm * b.ball.radius_mm - (to.squaredNorm() - along * along * length2);
    if (rest < 0) continue;
    const double half = std::sqrt(rest / length2);
    span.from = std::min(span.from, along - half);
    span.to = std::max(span.to, along + half);
    out.push_back(index);
  }
  return span;
}

Parts inRow(const std::vector<Bounds>& bounds, int v) {
  Parts out;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const cv::Rect& rect = bounds[i].rect;
    if (v >= rect.y && v < rect.y + rect.height) out.push_back(static_cast<std::uint8_t>(i));
  }
  return out;
}

cv::Rect unionOf(const std::vector<Bounds>& bounds) {
  cv::Rect out;
  for (const Bounds& b : bounds) out |= b.rect;
  return out;
}

}  // namespace

Picture Picture::clone() const {
  return {depth.clone(), id.clone(), ambient.clone(), direct.clone(), blind.clone()};
}

std::optional<double> meet(const Thing& thing, const Parts& among, const Vec3& origin,
                           const Vec3& direction, double from, double most) {
  const double length = direction.norm();
  const double careful = thing.fur_mm > 0 ? 0.7 : kCautious;
  double at = from;
  double outside = from;  // the last place known to be outside
  for (int i = 0; i < kSteps && at < most; ++i) {
    const double distance = nearest(thing, among, origin + at * direction).distance_mm;
    if (distance < kClose_mm) {
      if (distance >= 0) {  // a little further it is inside
        outside = at;
        at += 2.0 * kClose_mm / length;
        continue;
      }
      double inside = at;  // halved until the place is exact
      for (int k = 0; k < 40 && inside - outside > 1e-5 / length; ++k) {
        const double middle = 0.5 * (inside + outside);
        const bool is_inside = nearest(thing, among, origin + middle * direction).distance_mm < 0;
        (is_inside ? inside : outside) = middle;
      }
      return 0.5 * (inside + outside);
    }
    outside = at;
    at += careful * distance / length;
  }
  return std::nullopt;
}

Picture Renderer::empty() const {
  Picture out;
  out.depth = cv::Mat(size_, CV_32FC1, cv::Scalar(kNowhere));
  out.id = cv::Mat::zeros(size_, CV_8UC1);
  out.ambient = cv::Mat::zeros(size_, CV_32FC3);
  out.direct = cv::Mat::zeros(size_, CV_32FC3);
  out.blind = cv::Mat::zeros(size_, CV_8UC1);
  return out;
}

int Renderer::draw(const Thing& thing, const std::vector<Paint>& paints, Picture& picture) const {
  std::vector<Bounds> bounds;
  bounds.reserve(thing.parts.size());
  for (const Part& part : thing.parts) {
    const Ball ball = ballAround(thing, part);
    bounds.push_back(
        {rectOf({thing.pose.out(ball.centre_mm), ball.radius_mm}, camera_, size_), ball});
  }
  const cv::Rect reach = unionOf(bounds);
  const Mat3 inwards = thing.pose.turn.transpose();
  const Vec3 origin = thing.pose.in(Vec3::Zero());
  Parts on_ray;
  int filled = 0;
  for (int v = reach.y; v < reach.y + reach.height; ++v) {
    const Parts row = inRow(bounds, v);
    for (int u = reach.x; u < reach.x + reach.width; ++u) {
      const Vec3 ray = inwards * rayAt(u, v);
      const Span span = among(bounds, row, u, origin, ray, on_ray);
      if (on_ray.empty()) continue;
      const auto z = meet(thing, on_ray, origin, ray, std::max(span.from, 1.0), span.to);
      if (!z) continue;
      ++filled;
      if (*z >= double(picture.depth.at<float>(v, u))) continue;
      picture.depth.at<float>(v, u) = static_cast<float>(*z);
      picture.id.at<uchar>(v, u) = thing.id;
      shade(thing, on_ray, paints, {u, v}, *z, picture);
    }
  }
  return filled;
}

void Renderer::shade(const Thing& thing, const Parts& among, const std::vector<Paint>& paints,
                     const cv::Point& px, double z, Picture& picture) const {
  const Vec3 ray = rayAt(px.x, px.y);
  const Vec3 inner = thing.pose.in(z * ray);
  const Part& part = thing.parts[nearest(thing, among, inner).part];
  const Paint& paint = paints[part.paint];
  const Vec3 on_part = part.pose.in(inner);
  const Vec3 normal = thing.pose.turn * normalAt(thing, among, inner);
  const Color color = colorAt(paint, textured(part, on_part));
  const bool skin = paint.pattern == Pattern::kSkin || paint.pattern == Pattern::kFingertip;
  // Skin and fur let light in: the edge of their own shadow is soft.
  const double wrap = skin ? 0.25 : paint.pattern == Pattern::kFur ? 0.35 : 0.0;
  const double facing = (normal.dot(light_.towards) + wrap) / (1.0 + wrap);
  const Vec3 half = (light_.towards - ray.normalized()).normalized();
  const double glint = std::pow(std::max(0.0, normal.dot(half)), 60.0);
  const float glare = paint.gloss * static_cast<float>(glint);
  const auto from_above = static_cast<float>(0.62 + 0.38 * normal.dot(light_.up));
  const Color ambient = color.cwiseProduct(light_.around) * from_above;
  const Color direct = color.cwiseProduct(light_.lamp) * static_cast<float>(std::max(0.0, facing)) +
                       glare * light_.lamp;
  picture.ambient.at<cv::Vec3f>(px) = {ambient.x(), ambient.y(), ambient.z()};
  picture.direct.at<cv::Vec3f>(px) = {direct.x(), direct.y(), direct.z()};
  const bool grazing = std::abs(normal.dot(ray.normalized())) < 0.22;
  picture.blind.at<uchar>(px) =
      static_cast<uchar>((holeAt(paint, on_part) ? kSurface : 0) | (glare > 0.3F ? kGlare : 0) |
                         (grazing ? kGrazing : 0));
}

cv::Mat Renderer::develop(const Picture& picture, const Shadows& shadows, const Color& gain) const {
  static const std::vector<uchar> levels = [] {
    std::vector<uchar> out(4096);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = cv::saturate_cast<uchar>(255.0 * std::pow(double(i) / 4095.0, 1.0 / 2.2));
    return out;
  }();
  cv::Mat out(size_, CV_8UC3);
  for (int v = 0; v < size_.height; ++v) {
    for (int u = 0; u < size_.width; ++u) {
      const float lit = shadows.litAt(double(picture.depth.at<float>(v, u)) * rayAt(u, v));
      const cv::Vec3f light =
          picture.ambient.at<cv::Vec3f>(v, u) + lit * picture.direct.at<cv::Vec3f>(v, u);
      auto& pixel = out.at<cv::Vec3b>(v, u);
      for (int c = 0; c < 3; ++c) {
        // A shoulder instead of a hard end: what is very bright keeps some of its shape.
        float level = light[c] * gain[c];
        if (level > 0.7F) level = 0.7F + 0.3F * (1.0F - std::exp(-(level - 0.7F) / 0.3F));
        pixel[c] = levels[static_cast<std::size_t>(std::clamp(4095.0F * level, 0.0F, 4095.0F))];
      }
    }
  }
  cv::GaussianBlur(out, out, {}, 0.55);  // of the lens and of the sensor's colour filter
  return out;
}

Shadows::Shadows(const Light& light, const Vec3& middle_mm)
    : down_(-light.towards), distance_(kShadowMap, kShadowMap, CV_32FC1, cv::Scalar(kNowhere)) {
  across_ = down_.cross(Vec3::UnitZ()).normalized();
  along_ = down_.cross(across_);
  const double half = 0.5 * kShadowMap * kShadowCell_mm;
  corner_mm_ = middle_mm - half * (across_ + along_) - 1000.0 * down_;
}

Shadows Shadows::clone() const {
  Shadows out = *this;
  out.distance_ = distance_.clone();
  return out;
}

void Shadows::add(const Thing& thing) {
  std::vector<Bounds> bounds;
  bounds.reserve(thing.parts.size());
  for (const Part& part : thing.parts) {
    const Ball ball = ballAround(thing, part);
    const Vec3 off = thing.pose.out(ball.centre_mm) - corner_mm_;
    const auto cell = [](double mm) { return static_cast<int>(std::floor(mm / kShadowCell_mm)); };
    const int u = cell(off.dot(across_) - ball.radius_mm);
    const int v = cell(off.dot(along_) - ball.radius_mm);
    const int side = cell(2.0 * ball.radius_mm) + 2;
    bounds.push_back({cv::Rect(u, v, side, side) & cv::Rect(0, 0, kShadowMap, kShadowMap), ball});
  }
  const cv::Rect reach = unionOf(bounds);
  const Vec3 ray = thing.pose.turn.transpose() * down_;
  Parts on_ray;
  for (int v = reach.y; v < reach.y + reach.height; ++v) {
    const Parts row = inRow(bounds, v);
    for (int u = reach.x; u < reach.x + reach.width; ++u) {
      const Vec3 origin =
          thing.pose.in(corner_mm_ + kShadowCell_mm * ((u + 0.5) * across_ + (v + 0.5) * along_));
      const Span span = among(bounds, row, u, origin, ray, on_ray);
      if (on_ray.empty()) continue;
      const auto at = meet(thing, on_ray, origin, ray, std::max(span.from, 0.0), span.to);
      float& nearest_mm = distance_.at<float>(v, u);
      if (at) nearest_mm = std::min(nearest_mm, static_cast<float>(*at));
    }
  }
}

float Shadows::litAt(const Vec3& at_mm) const {
  const Vec3 off = at_mm - corner_mm_;
  const double x = off.dot(across_) / kShadowCell_mm;
  const double y = off.dot(along_) / kShadowCell_mm;
  constexpr int kReach = 2;
  const int u = static_cast<int>(std::floor(x)) - kReach;
  const int v = static_cast<int>(std::floor(y)) - kReach;
  if (x < 0 || y < 0 || u < 0 || v < 0 || u + 2 * kReach + 1 >= kShadowMap ||
      v + 2 * kReach + 1 >= kShadowMap)
    return 1.0F;
  const auto here = static_cast<float>(off.dot(down_) - kShadowBias_mm);
  const auto fu = static_cast<float>(x - std::floor(x));
  const auto fv = static_cast<float>(y - std::floor(y));
  // Cells about the place, those at the ends by the part of them that is within reach.
  float lit = 0.0F;
  for (int j = 0; j <= 2 * kReach; ++j) {
    const float wv = j == 0 ? 1.0F - fv : j == 2 * kReach ? fv : 1.0F;
    const auto* row = distance_.ptr<float>(v + j);
    for (int i = 0; i <= 2 * kReach; ++i) {
      const float wu = i == 0 ? 1.0F - fu : i == 2 * kReach ? fu : 1.0F;
      if (row[u + i] > here) lit += wu * wv;
    }
  }
  constexpr float kAll = 2.0F * kReach * 2.0F * kReach;
  return lit / kAll;
}

}  // namespace hapticast::evaluate::held
