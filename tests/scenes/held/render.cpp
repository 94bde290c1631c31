// SPDX-License-Identifier: MIT
#include "tests/scenes/held/render.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/scenes/held/reach.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr int kSteps = 96;          // rays that graze take many
constexpr double kExact_mm = 1e-4;  // a root is found within this
constexpr double kStep_mm = 0.02;   // added to each, so that the surface is crossed
constexpr double kCautious = 0.85;  // of an ellipsoid's distance, which is not quite a bound
constexpr int kShadowMap = 216;
constexpr double kShadowCell_mm = 4.0;
constexpr double kShadowBias_mm = 7.0;
constexpr float kNowhere = 1e9F;

struct Place {
  double along = 0.0;
  double distance_mm = 0.0;
};

// Where the distance is 0: by the straight line through both ends, and where one end stays, with
// half of its distance, so that it moves, too (the Illinois rule).
template <class Distance>
double rootBetween(Place outside, Place inside, const Distance& distanceAt) {
  Place middle = inside;
  int stayed = 0;  // > 0: how often the inner end did
  for (int i = 0; i < 30; ++i) {
    const double share = outside.distance_mm / (outside.distance_mm - inside.distance_mm);
    middle.along = outside.along + share * (inside.along - outside.along);
    middle.distance_mm = distanceAt(middle.along);
    if (std::abs(middle.distance_mm) < kExact_mm) break;
    if (middle.distance_mm > 0) {
      outside = middle;
      stayed = std::max(1, stayed + 1);
      if (stayed > 1) inside.distance_mm *= 0.5;
    } else {
      inside = middle;
      stayed = std::min(-1, stayed - 1);
      if (stayed < -1) outside.distance_mm *= 0.5;
    }
  }
  return middle.along;
}

}  // namespace

Picture Picture::clone() const {
  return {depth.clone(), id.clone(), ambient.clone(), direct.clone(), blind.clone()};
}

std::optional<double> meet(const Thing& thing, const Parts& among, const Vec3& origin,
                           const Vec3& direction, double from, double most) {
  const auto distanceAt = [&](double along) {
    return nearest(thing, among, origin + along * direction).distance_mm;
  };
  const double length = direction.norm();
  const bool bounds = std::none_of(among.begin(), among.end(), [&](std::uint8_t part) {
    return thing.parts[part].form == Form::kEllipsoid;
  });
  const double careful = thing.fur_mm > 0 ? 0.75 : bounds ? 1.0 : kCautious;
  double outside = from;
  double gap_mm = distanceAt(from);
  if (gap_mm < 0) return from;
  for (int i = 0; i < kSteps && outside < most; ++i) {
    const double at = outside + (careful * gap_mm + kStep_mm) / length;
    const double next_mm = distanceAt(at);
    if (next_mm < 0) return rootBetween({outside, gap_mm}, {at, next_mm}, distanceAt);
    outside = at;
    gap_mm = next_mm;
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
  const Reach reach(thing, size_,
                    [this](const Ball& ball) { return rectOf(ball, camera_, size_); });
  const cv::Rect& rect = reach.rect();
  const Mat3 inwards = thing.pose.turn.transpose();
  const Vec3 origin = thing.pose.in(Vec3::Zero());
  Parts on_ray;
  int filled = 0;
  for (int v = rect.y; v < rect.y + rect.height; ++v) {
    const Parts row = reach.inRow(v);
    for (int u = rect.x; u < rect.x + rect.width; ++u) {
      const Vec3 ray = inwards * rayAt(u, v);
      const Reach::Span span = reach.onRay(row, u, origin, ray, on_ray);
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

void Shadows::add(const Thing& casts) {
  Thing thing = casts;
  thing.fur_mm = 0.0;  // its shadow is soft anyway
  const Reach reach(thing, distance_.size(), [&](const Ball& ball) {
    const Vec3 off = ball.centre_mm - corner_mm_;
    const auto cell = [](double mm) { return static_cast<int>(std::floor(mm / kShadowCell_mm)); };
    const int side = cell(2.0 * ball.radius_mm) + 2;
    return cv::Rect(cell(off.dot(across_) - ball.radius_mm), cell(off.dot(along_) - ball.radius_mm),
                    side, side);
  });
  const cv::Rect& rect = reach.rect();
  const Vec3 ray = thing.pose.turn.transpose() * down_;
  Parts on_ray;
  for (int v = rect.y; v < rect.y + rect.height; ++v) {
    const Parts row = reach.inRow(v);
    for (int u = rect.x; u < rect.x + rect.width; ++u) {
      const Vec3 origin =
          thing.pose.in(corner_mm_ + kShadowCell_mm * ((u + 0.5) * across_ + (v + 0.5) * along_));
      const Reach::Span span = reach.onRay(row, u, origin, ray, on_ray);
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
