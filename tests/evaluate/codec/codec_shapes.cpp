// SPDX-License-Identifier: MIT
#include "tests/evaluate/codec/codec_shapes.hpp"

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "server/source/synthetic/synthetic_source.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/body_scene.hpp"
#include "tests/scenes/relief_scenes.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The largest object of every few frames of a source, by the whole of vision.
CodecShape throughVision(const std::string& name, server::RgbdSource& source,
                         const server::VisionSettings& settings, std::size_t count, int every) {
  CodecShape out{name, {}, false, false};
  server::Vision vision(source.info(), settings);
  int seen = 0;
  while (auto frame = source.read()) {
    const auto result = vision.push(*frame, mediaTime(double(frame->index) / source.info().fps));
    if (!result || seen++ % every != 0) continue;
    const Relief* largest = nullptr;
    for (const HapticObject& object : result->frame.objects) {
      if (largest == nullptr || object.relief->mask.size() > largest->mask.size())
        largest = object.relief.get();
    }
    if (largest != nullptr) out.frames.push_back(*largest);
    if (out.frames.size() == count) break;
  }
  return out;
}

CodecShape body(const std::string& name, const HeightAt& height_mm, bool eight_bit, double turns) {
  const MotionAt motion = [turns](double t) {
    Motion out;
    out.position_mm = Vec3(1.37 + 3.0 * t, -0.81 - 2.0 * t, 0.0);
    out.angle_rad = turns * t;
    out.angular_velocity_rad_s = turns;
    out.velocity_mm_s = Vec3(3.0, -2.0, 0.0);
    return out;
  };
  const TouchScene scene = reliefScene({name, height_mm, 59.0, 1.0, motion});
  const auto source = scene.open({eight_bit, true});
  return throughVision(name, *source, {}, 4, 3);
}

HeightAt ellipsoid(double a, double b, double c) {
  return [=](const Vec2& q, double) {
    const double rest = 1.0 - q.x() * q.x() / (a * a) - q.y() * q.y() / (b * b);
    return rest > 0.0 ? c * std::sqrt(rest) : kNone;
  };
}

double boxAt(const Vec2& q, double) {  // three faces of a box that lies on an edge
  if (std::abs(q.x()) > 27.0 || std::abs(q.y()) > 24.0) return kNone;
  return q.x() < 8.0 ? 20.0 + 0.3 * q.x() - 0.1 * q.y() : 31.2 - 1.1 * q.x() - 0.1 * q.y();
}

double reliefAt(const Vec2& q, double) {  // a disc with ripples of 3 to 8 mm
  if (q.norm() > 30.0) return kNone;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return 15.0 + 0.1 * q.x() + 0.8 * std::sin(kTurn * (q.x() + 0.4 * q.y()) / 8.0) +
         0.4 * std::sin(kTurn * (0.7 * q.y() - 0.5 * q.x()) / 4.7) +
         0.15 * std::sin(kTurn * (q.x() * 0.9 + q.y() * 0.6) / 3.1);
}

double ringAt(const Vec2& q, double) {  // half of a torus: a mask with a hole
  const double across = (q.norm() - 22.0) / 9.0;
  return std::abs(across) < 1.0 ? 4.0 + 9.0 * std::sqrt(1.0 - across * across) : kNone;
}

double starAt(const Vec2& q, double) {  // a saddle with a jagged outline
  const double angle = std::atan2(q.y(), q.x());
  if (q.norm() > 24.0 + 7.0 * std::sin(9.0 * angle)) return kNone;
  return 14.0 + 0.012 * (q.x() * q.x() - q.y() * q.y()) + 2.0 * std::exp(-q.squaredNorm() / 18.0);
}

// A half sphere of 8 bits with noise of 1.5 levels, smoothed by a Gaussian of 3 px inside its mask:
// a rim that is rounded off.
CodecShape gaussianBall(std::size_t count) {
  CodecShape out{"ball, Gaussian 3 px", {}, false, true};
  cv::RNG random(7);
  for (std::size_t k = 0; k < count; ++k) {
    constexpr int kSide_px = 240;
    cv::Mat height(kSide_px, kSide_px, CV_32FC1, cv::Scalar(0));
    cv::Mat inside(kSide_px, kSide_px, CV_32FC1, cv::Scalar(0));
    for (int v = 0; v < kSide_px; ++v) {
      for (int u = 0; u < kSide_px; ++u) {
        const Vec2 q = 0.25 * (Vec2(u, v) - Vec2::Constant(119.5 + 0.13 * double(k)));
        if (q.norm() >= 30.0) continue;
        inside.at<float>(v, u) = 1.0F;
        const double levels = 8.5 * std::sqrt(900.0 - q.squaredNorm()) + random.gaussian(1.5);
        height.at<float>(v, u) = float(std::clamp(std::round(levels), 0.0, 255.0) / 8.5);
      }
    }
    cv::Mat sum;
    cv::Mat weight;
    cv::GaussianBlur(height, sum, {}, 3.0, 3.0, cv::BORDER_CONSTANT);
    cv::GaussianBlur(inside, weight, {}, 3.0, 3.0, cv::BORDER_CONSTANT);
    Relief relief{{0, 0, kSide_px, kSide_px}, {}, {}};
    for (int v = 0; v < kSide_px; ++v) {
      for (int u = 0; u < kSide_px; ++u) {
        const bool in = inside.at<float>(v, u) > 0.0F;
        relief.mask.push_back(in ? 1 : 0);
        relief.height_mm.push_back(in ? sum.at<float>(v, u) / weight.at<float>(v, u) : 0.0F);
      }
    }
    out.frames.push_back(std::move(relief));
  }
  return out;
}

std::vector<CodecShape> bodies(bool quick) {
  std::vector<CodecShape> out{body("ball", ellipsoid(30, 30, 30), true, 0.0)};
  out.push_back(gaussianBall(quick ? 1 : 4));
  if (quick) return out;
  out.push_back(body("ellipsoid", ellipsoid(40, 26, 22), true, 1.7));
  out.push_back(body("box", boxAt, true, 1.7));
  out.push_back(body("relief", reliefAt, true, 1.7));
  for (CodecShape& shape : out) shape.tuned = true;  // what follows is not
  out.push_back(body("ball, exact depth", ellipsoid(30, 30, 30), false, 0.0));
  out.push_back(body("ring", ringAt, true, 1.7));
  out.push_back(body("star", starAt, true, 1.7));
  return out;
}

// Bodies before a pinhole camera through sensors with noise.
std::vector<CodecShape> sensed(bool quick) {
  std::vector<CodecShape> out;
  if (quick) return out;
  using Depth = Sensor::Depth;
  for (const auto& [name, depth] :
       {std::pair{"stereo", Depth::kStereo}, std::pair{"time of flight", Depth::kTimeOfFlight}}) {
    Sensor sensor;
    sensor.depth = depth;
    TestSource source(motionScenes()[3], sensor, 25.0, true);
    out.push_back(throughVision("general motion, " + std::string(name), source, {}, 4, 5));
  }
  return out;
}

struct RealObject {
  const char* clip;
  const char* name;
  Vec2 point_px;
  bool tuned;
};
const RealObject kObjects[] = {{"visp_rbt_desk", "dragon", {505, 330}, true},
                               {"visp_rbt_desk", "cube", {270, 300}, true},
                               {"visp_rbt_desk", "phantom", {430, 270}, false},
                               {"dkvfx_typing_person", "person", {125, 260}, false}};

// Near and far of what is inside, but for a hundredth at either end.
server::DepthRange sceneRange(const cv::Mat& depth, const cv::Mat& mask) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(cv::countNonZero(mask)));
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (mask.at<uchar>(v, u) != 0) values.push_back(depth.at<float>(v, u));
    }
  }
  const auto at = [&](double share) {
    const auto nth = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return double(*nth);
  };
  return {at(0.01), std::max(at(0.99), at(0.01) + 30.0)};
}

// The heights of a mask's depth, as the server smooths them or as they are.
Relief makeRelief(const cv::Mat& depth, const cv::Mat& mask, bool raw) {
  Workspace workspace;
  workspace.width_px = depth.cols;
  workspace.height_px = depth.rows;
  const server::DepthNoise noise = server::measureNoise(depth);
  const server::Surface surface =
      raw ? server::rawSurface(depth, mask, noise)
          : server::cleanSurface(depth, mask, noise, Method::kHapticast);
  return *server::makeRelief(surface, sceneRange(depth, mask), workspace, Method::kHapticast, !raw);
}

// The reliefs of a whole clip: all pixels with depth (`region` empty), or those of a rectangle.
CodecShape whole(const std::string& name, const std::filesystem::path& clip, const cv::Rect& region,
                 bool raw, std::size_t count) {
  const auto source = server::openSource(clip.string(), 0.0);
  CodecShape out{name, {}, raw, false};
  while (auto frame = source->read()) {
    cv::Mat mask = frame->depth > 0.0F;
    if (!region.empty()) {
      cv::Mat inside = cv::Mat::zeros(mask.size(), CV_8UC1);
      inside(region).setTo(255);
      mask &= inside;
    }
    if (!raw) cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8UC1));
    if (frame->index % 6 == 0) out.frames.push_back(makeRelief(frame->depth, mask, raw));
    if (out.frames.size() == count) break;
  }
  return out;
}

// The relief's own mask, its heights straight from the sensor's depth.
Relief rawOf(const Relief& relief, const cv::Mat& depth) {
  cv::Mat mask = cv::Mat::zeros(depth.size(), CV_8UC1);
  const cv::Mat inside(relief.rect.height, relief.rect.width, CV_8UC1,
                       const_cast<std::uint8_t*>(relief.mask.data()));
  cv::Mat(inside != 0)
      .copyTo(mask(cv::Rect(relief.rect.u, relief.rect.v, relief.rect.width, relief.rect.height)));
  mask &= depth > 0.0F;
  return makeRelief(depth, mask, true);
}

std::vector<CodecShape> realObject(const RealObject& object, std::size_t count) {
  const auto source = server::openSource((test::clipsFolder() / object.clip).string(), 0.0);
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kBand;
  settings.object_points = {{object.point_px}};
  CodecShape smooth = throughVision(object.name, *source, settings, count, 5);
  smooth.tuned = object.tuned;
  CodecShape raw{std::string(object.name) + ", raw", {}, true, object.tuned};
  source->rewind();
  for (const Relief& relief : smooth.frames) {
    if (auto frame = source->read()) raw.frames.push_back(rawOf(relief, frame->depth));
  }
  return {smooth, raw};
}

}  // namespace

std::vector<CodecShape> codecShapes(bool quick, Report& report) {
  std::vector<CodecShape> out = bodies(quick);
  const auto take = [&](std::vector<CodecShape> more) {
    for (CodecShape& shape : more) {
      if (!shape.frames.empty()) out.push_back(std::move(shape));
    }
  };
  take(sensed(quick));
  const std::size_t count = quick ? 1 : 4;
  const auto present = [&](const char* clip, const std::string& shape) {
    if (std::filesystem::exists(test::clipsFolder() / clip)) return true;
    report.leaveOut(shape);
    report.leaveOut(shape + ", raw");
    return false;
  };
  const std::filesystem::path small(HAPTICAST_SMALL_CLIP);
  for (const bool raw : {false, true})
    take({whole(raw ? "hands, raw" : "hands", small, {}, raw, count)});
  if (present("dkvfx_typing_person", "whole person")) {
    const auto clip = test::clipsFolder() / "dkvfx_typing_person";
    take({whole("whole person", clip, {}, false, count),
          whole("whole person, raw", clip, {}, true, count)});
  }
  if (present("tum_fr1_rpy", "desk region")) {
    const auto clip = test::clipsFolder() / "tum_fr1_rpy";
    const cv::Rect region(100, 60, 120, 110);
    take({whole("desk region", clip, region, false, count),
          whole("desk region, raw", clip, region, true, count)});
  }
  if (quick) return out;
  for (const RealObject& object : kObjects) {
    if (present(object.clip, object.name)) take(realObject(object, count));
  }
  return out;
}

}  // namespace hapticast::evaluate
