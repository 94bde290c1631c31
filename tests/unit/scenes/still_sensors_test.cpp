// SPDX-License-Identifier: MIT
// A minute of stillness through four kinds of sensors, and how what is held goes over.
#include <gtest/gtest.h>

#include "server/vision/base/masks.hpp"
#include "server/vision/surface/static_region_filter.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

enum class Kind : std::uint8_t { kStructured, kFlight, kRoom8, kEstimate };
constexpr double kLevel_mm = 1.57;

// A furry ball: half of it is hardly measured.
class SurfaceModelOfStillBall {
 public:
  explicit SurfaceModelOfStillBall(Kind kind) : kind_(kind), exact_(scene_.frame(0, 70, 56)) {
    cv::cvtColor(exact_.color, gray_, cv::COLOR_BGR2GRAY);
    fixed_ = noise(0.7, 0.0);
    noise_.sigma_mm = {kind == Kind::kEstimate ? 0.3 : 1.0};
    if (kind == Kind::kRoom8) noise_ = {{0.5 * kLevel_mm}, kLevel_mm};
    noise_.eight_bit = kind == Kind::kRoom8;
    noise_.flickers = kind == Kind::kEstimate;
  }

  Surface next(double nearer_mm = 0.0, const cv::Rect& where = {}) {
    cv::Mat depth = exact_.depth.clone();
    if (!where.empty()) depth(where) -= nearer_mm;
    depth = sensed(depth);
    now_gray_ = gray_.clone();
    cv::Mat trembling = noise(1.5, 0.0);
    cv::add(gray_, trembling, now_gray_, cv::noArray(), CV_8U);
    const cv::Mat whole = exact_.mask * 255;
    cv::Mat mask = whole.clone();
    cv::Mat flips(mask.size(), CV_8UC1);
    random_.fill(flips, cv::RNG::UNIFORM, 0, 2);
    cv::Mat(flips * 255).copyTo(mask, dilateBy(whole, 1) & ~erodeBy(whole, 1));
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8UC1));
    const Surface seen = cleanSurface(depth, mask, noise_, Method::kHapticast);
    return hold_.apply(now_gray_, seen, computeStaticNoise(noise_, seen), false);
  }
  [[nodiscard]] const StaticRegionFilter& hold() const { return hold_; }

 private:
  cv::Mat noise(double sigma, double blur_px) {
    cv::Mat out(exact_.depth.size(), CV_32FC1);
    random_.fill(out, cv::RNG::NORMAL, 0.0, 1.0);
    if (blur_px > 0) cv::GaussianBlur(out, out, {}, blur_px);
    return out * (sigma * (blur_px > 0 ? 2 * blur_px * std::sqrt(CV_PI) : 1.0));
  }

  cv::Mat sensed(const cv::Mat& exact) {
    cv::Mat out = exact.clone();
    if (kind_ == Kind::kRoom8) {
      cv::Mat levels;
      cv::Mat((out + noise(0.4 * kLevel_mm, 1.2)) / kLevel_mm).convertTo(levels, CV_32S);
      levels.convertTo(out, CV_32F, kLevel_mm);
      return out;
    }
    if (kind_ == Kind::kEstimate) {
      cv::Mat wide(4, 5, CV_32FC1);
      random_.fill(wide, cv::RNG::NORMAL, 0.0, 0.6);
      cv::resize(wide, wide, out.size(), 0, 0, cv::INTER_CUBIC);
      return out + wide;
    }
    const cv::Mat blobs = noise(1.0, 2.5);
    if (kind_ == Kind::kFlight) {
      out += noise(1.4, 0.0) + fixed_;
      out.setTo(0, blobs > 2.0);
      return out;
    }
    out += noise(0.7, 1.3);
    cv::Mat rounded;
    out.convertTo(rounded, CV_32S);
    rounded.convertTo(out, CV_32F);
    out.setTo(0, blobs > 2.0);
    const cv::Rect fur(0, 0, 70, out.rows);
    out(fur).setTo(0, blobs(fur) > -0.3);
    return out;
  }

  Kind kind_;
  test::BallScene scene_{.width = 140, .height = 112, .radius_px = 40};
  RgbdFrame exact_;
  cv::Mat gray_;
  cv::Mat now_gray_;
  cv::RNG random_{42};
  cv::Mat fixed_;
  DepthNoise noise_;
  StaticRegionFilter hold_;
};

class StillSensors : public ::testing::TestWithParam<Kind> {};

TEST_P(StillSensors, AMinuteWithoutAReleaseOrATremor) {
  SurfaceModelOfStillBall ball(GetParam());
  Surface settled;
  int changes = 0;
  for (int i = 0; i < 1500; ++i) {
    const Surface now = ball.next();
    if (i < 25) continue;
    if (i == 25) settled = now;
    const bool same = now.box == settled.box && equalImages(now.mask, settled.mask) &&
                      equalImages(now.depth, settled.depth);
    changes += same ? 0 : 1;
  }
  EXPECT_EQ(changes, 0);
}

INSTANTIATE_TEST_SUITE_P(All, StillSensors,
                         ::testing::Values(Kind::kStructured, Kind::kFlight, Kind::kRoom8,
                                           Kind::kEstimate));

// A part comes nearer while its colours stay: it is let go, but no frame makes a step of it.
TEST(StillSensorsBalls, ATileReleasedByItsDepthChangesSmoothly) {
  const cv::Rect part(64, 40, 32, 32);
  SurfaceModelOfStillBall ball(Kind::kFlight);
  Surface last;
  for (int i = 0; i < 30; ++i) last = ball.next();
  double largest_mm = 0.0;
  Cause cause = Cause::kNone;
  const cv::Rect inner(part.tl() + cv::Point(8, 8), cv::Size(16, 16));
  const auto depthOf = [&](const Surface& surface) {
    return cv::mean(surface.depth(inner - surface.box.tl()))[0];
  };
  const double before_mm = depthOf(last);
  for (int i = 0; i < 20; ++i) {
    const Surface now = ball.next(12.0, part);
    largest_mm = std::max(largest_mm, std::abs(depthOf(now) - depthOf(last)));
    if (ball.hold().cause() != Cause::kNone) cause = ball.hold().cause();
    last = now;
  }
  EXPECT_EQ(cause, Cause::kDepth);
  EXPECT_NEAR(before_mm - depthOf(last), 12.0, 1.5);
  EXPECT_LT(largest_mm, 5.0);
}

TEST(StillSensorsBalls, OneFrameReleasesNothing) {
  SurfaceModelOfStillBall ball(Kind::kStructured);
  Surface settled;
  for (int i = 0; i < 30; ++i) settled = ball.next();
  for (int i = 0; i < 40; ++i) {
    const bool wrong = i % 10 == 3;
    const Surface now = ball.next(wrong ? -150.0 : 0.0, {64, 30, 34, 34});
    EXPECT_TRUE(equalImages(now.depth, settled.depth)) << i;
  }
}

}  // namespace
}  // namespace hapticast::server
