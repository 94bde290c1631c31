// SPDX-License-Identifier: MIT
// Recordings of an Azure Kinect or Orbbec: depth and colour cameras at different places with
// distorting lenses, against ray casting.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "server/source/scale/kinect_calibration.hpp"
#include "server/source/video/video_clip.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kTilt = 0.1;  // rotation of the colour camera about its x axis, rad

/// The text that recorders attach. The colour camera is 32 mm beside the depth camera.
std::string calibrationText(const std::string& model = "BrownConrady", int sensor_height = 3072) {
  const double fy = sensor_height == 3072 ? 0.63 : 0.63 * 4.0 / 3.0;
  const double cy = sensor_height == 3072 ? 0.505 : (0.505 - 0.125) / 0.75;
  return fmt::format(
      R"({{"CalibrationInformation": {{"Cameras": [
      {{"Purpose": "CALIBRATION_CameraPurposeDepth", "SensorWidth": 1024, "SensorHeight": 1024,
        "Intrinsics": {{"ModelType": "CALIBRATION_LensDistortionModel{0}",
          "ModelParameters": [0.512, 0.494, 0.492, 0.492, 3.13, 2.32, 0.13, 3.46, 3.35, 0.66,
                              0, 0, -0.0005, 0.0008]}},
        "Rt": {{"Rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Translation": [0, 0, 0]}}}},
      {{"Purpose": "CALIBRATION_CameraPurposePhotoVideo", "SensorWidth": 4096,
        "SensorHeight": {1},
        "Intrinsics": {{"ModelType": "CALIBRATION_LensDistortionModel{0}",
          "ModelParameters": [0.497, {2}, 0.471, {3}, 0.72, -2.89, 1.63, 0.60, -2.72, 1.57,
                              0, 0, -0.0003, 0.0006]}},
        "Rt": {{"Rotation": [1, 0, 0, 0, {4}, {5}, 0, {6}, {4}],
                "Translation": [-0.032, -0.002, 0.004]}}}}]}}}})",
      model, sensor_height, cy, fy, std::cos(kTilt), std::sin(kTilt), -std::sin(kTilt));
}

/// The lens as it is published, apart from the product's own code.
cv::Point2d throughLens(const LensCamera& camera, double x, double y) {
  const auto& d = camera.distortion;
  const double r2 = x * x + y * y;
  const double r4 = r2 * r2;
  const double r6 = r4 * r2;
  const double radial =
      (1 + d[0] * r2 + d[1] * r4 + d[4] * r6) / (1 + d[5] * r2 + d[6] * r4 + d[7] * r6);
  const double u = x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x);
  const double v = y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y;
  return {u * camera.matrix(0, 0) + camera.matrix(0, 2),
          v * camera.matrix(1, 1) + camera.matrix(1, 2)};
}

/// Returns the point at Z = 1 that the pixel shows, by fixed-point iteration.
cv::Vec3d rayOf(const LensCamera& camera, double u, double v) {
  double x = (u - camera.matrix(0, 2)) / camera.matrix(0, 0);
  double y = (v - camera.matrix(1, 2)) / camera.matrix(1, 1);
  for (int i = 0; i < 40; ++i) {
    const cv::Point2d place = throughLens(camera, x, y);
    x += (u - place.x) / camera.matrix(0, 0);
    y += (v - place.y) / camera.matrix(1, 1);
  }
  return {x, y, 1.0};
}

/// Where a ray from `origin` along `ray` meets a sphere before a slanted wall, in multiples of
/// `ray`, all in the depth camera's axes. `ball` becomes true on the sphere.
double castRay(const cv::Vec3d& origin, const cv::Vec3d& ray, bool& ball) {
  const cv::Vec3d middle(40.0, 30.0, 800.0);
  const double radius = 180.0;
  const cv::Vec3d from = origin - middle;
  const double half = ray.dot(from);
  const double root = half * half - ray.dot(ray) * (from.dot(from) - radius * radius);
  ball = root > 0.0;
  if (ball) return (-half - std::sqrt(root)) / ray.dot(ray);
  const cv::Vec3d normal(0.1, -0.15, 1.0);
  return (1300.0 - normal.dot(origin)) / normal.dot(ray);
}

/// Returns what a camera sees: depth along its axis (CV_32FC1). `rotation` and `move_mm`: from the
/// depth camera's axes to its own.
cv::Mat castPicture(const LensCamera& camera, const cv::Matx33d& rotation, const cv::Vec3d& move_mm,
                    cv::Mat& ball) {
  cv::Mat depth(camera.size, CV_32FC1);
  ball = cv::Mat::zeros(camera.size, CV_8UC1);
  const cv::Vec3d origin = -(rotation.t() * move_mm);
  for (int v = 0; v < camera.size.height; ++v) {
    for (int u = 0; u < camera.size.width; ++u) {
      bool on_ball = false;
      depth.at<float>(v, u) =
          static_cast<float>(castRay(origin, rotation.t() * rayOf(camera, u, v), on_ball));
      ball.at<unsigned char>(v, u) = on_ball ? 255 : 0;
    }
  }
  return depth;
}

class KinectVideo : public VideoFilesTest {
 protected:
  /// Writes k4a.mkv from color.png and depth.png, with `calibration` if it is not empty.
  void record(const std::string& calibration) const {
    folder.write("calibration.json", calibration);
    const std::string attach =
        calibration.empty() ? ""
                            : "-attach calibration.json -metadata:s:t mimetype=application/json "
                              "-metadata:s:t filename=calibration.json ";
    ffmpeg("-i color.png -i depth.png " + attach +
           "-map 0 -map 1 -c:v:0 ffv1 -pix_fmt:v:0 bgr0 -c:v:1 ffv1 -pix_fmt:v:1 gray16le "
           "-metadata:s:v:1 K4A_DEPTH_TRACK=2 k4a.mkv");
  }
  /// Draws the scene for both cameras. Returns the depth that the colour camera has.
  cv::Mat draw(cv::Size color_size, cv::Size depth_size, cv::Mat& ball) const {
    const KinectCalibration calibration = parseKinectCalibration(calibrationText(), "test");
    cv::Mat seen;
    const cv::Mat depth =
        castPicture(*depthCamera(calibration, depth_size), cv::Matx33d::eye(), cv::Vec3d(), seen);
    cv::Mat levels;
    depth.convertTo(levels, CV_16U);
    folder.write("depth.png", levels);
    cv::Mat truth = castPicture(*colorCamera(calibration, color_size), calibration.rotation,
                                calibration.translation_mm, ball);
    cv::Mat color(color_size, CV_8UC3, cv::Scalar(90, 110, 80));
    color.setTo(cv::Scalar(60, 140, 220), ball);
    folder.write("color.png", color);
    return truth;
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder / name).string(); }
};

TEST_F(KinectVideo, DepthIsRegisteredToColour) {
  struct Mode {
    cv::Size color, depth;
  };
  for (const Mode& mode : {Mode{{1280, 720}, {640, 576}}, Mode{{2048, 1536}, {320, 288}}}) {
    SCOPED_TRACE(mode.color);
    cv::Mat ball;
    cv::Mat truth = draw(mode.color, mode.depth, ball);
    record(calibrationText());
    const LogLines log;
    const auto source = openSource(at("k4a.mkv"), 0.0);
    EXPECT_THAT(log.text(), HasSubstr("is registered to its colour"));
    EXPECT_THAT(log.text(), testing::Not(HasSubstr("warning")));
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    const cv::Size size = frame->color.size();
    cv::resize(truth, truth, size, 0.0, 0.0, cv::INTER_NEAREST_EXACT);
    cv::resize(ball, ball, size, 0.0, 0.0, cv::INTER_NEAREST_EXACT);
    // Inside the depth camera's view, apart from the outline, behind which the depth camera sees
    // another part of the wall than the colour camera.
    const cv::Rect inner(size.width / 4, size.height / 4, size.width / 2, size.height / 2);
    const cv::Mat measured = frame->depth(inner) > 0.0F;
    const cv::Mat error = cv::abs(frame->depth(inner) - truth(inner));
    const double share = double(cv::countNonZero(measured)) / inner.area();
    const double close =
        double(cv::countNonZero((error < 8.0F) & measured)) / cv::countNonZero(measured);
    const double mean_mm = cv::mean(error, measured & (error < 50.0F))[0];
    cv::Mat near = frame->depth < 1000.0F;
    near.setTo(0, frame->depth == 0.0F);
    const double overlap = double(cv::countNonZero(near & ball)) / cv::countNonZero(near | ball);
    fmt::print("{} x {}: measured {:.3f}, within 8 mm {:.3f}, mean error {:.2f} mm, ball {:.3f}\n",
               size.width, size.height, share, close, mean_mm, overlap);
    EXPECT_GT(share, 0.93);
    EXPECT_GT(close, 0.97);
    EXPECT_LT(mean_mm, 2.0);
    EXPECT_GT(overlap, 0.97);
    ASSERT_TRUE(source->info().camera);
    EXPECT_NEAR(source->info().camera->fx_px, 0.471 * size.width, 1.0);
  }
}

TEST_F(KinectVideo, WithoutCalibrationIsReportedAsUnaligned) {
  folder.write("color.png", cv::Mat(288, 320, CV_8UC3, cv::Scalar::all(90)));
  folder.write("depth.png", cv::Mat(288, 320, CV_16UC1, cv::Scalar(700)));
  record("");
  const LogLines log;
  const auto source = openSource(at("k4a.mkv"), 0.0);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("without calibration"), HasSubstr("not aligned")));
  EXPECT_EQ(source->read()->depth.at<float>(5, 5), 700.0F);
  record(calibrationText());
  const LogLines other;
  (void)openSource(at("k4a.mkv"), 0.0);
  EXPECT_THAT(other.text(), HasSubstr("of sizes that its calibration does not know"));
}

TEST_F(KinectVideo, DamagedCalibrationIsRefusedInOneLine) {
  folder.write("color.png", cv::Mat(720, 1280, CV_8UC3, cv::Scalar::all(90)));
  folder.write("depth.png", cv::Mat(288, 320, CV_16UC1, cv::Scalar(700)));
  record("{\"CalibrationInformation\": 1}");
  EXPECT_THAT(openError(at("k4a.mkv")),
              HasSubstr("k4a.mkv: its calibration.json:1:2: 'CalibrationInformation' is no JSON"));
  record(calibrationText("Theta"));
  EXPECT_THAT(openError(at("k4a.mkv")),
              HasSubstr("'ModelType' is another model than BrownConrady"));
}

TEST(KinectCalibration, ColourOfBothAspectsIsThatOfOneSensor) {
  const KinectCalibration calibration = parseKinectCalibration(calibrationText(), "test");
  const auto whole = colorCamera(calibration, {2048, 1536});
  const auto crop = colorCamera(calibration, {1280, 720});
  ASSERT_TRUE(whole && crop);
  EXPECT_NEAR(crop->matrix(0, 0), 0.471 * 1280, 1e-9);
  EXPECT_NEAR(crop->matrix(1, 1), 0.63 * 960, 1e-9);
  EXPECT_NEAR(crop->matrix(1, 2), 0.505 * 960 - 120 - 0.5, 1e-9);
  EXPECT_NEAR(whole->matrix(1, 2), 0.505 * 1536 - 0.5, 1e-9);
  EXPECT_FALSE(colorCamera(calibration, {640, 640}));
  const KinectCalibration older =
      parseKinectCalibration(calibrationText("BrownConrady", 2304), "t");
  EXPECT_NEAR(colorCamera(older, {1280, 720})->matrix(1, 2), crop->matrix(1, 2), 1e-6);
  EXPECT_NEAR(colorCamera(older, {1280, 720})->matrix(1, 1), crop->matrix(1, 1), 1e-6);
  const auto depth = depthCamera(calibration, {640, 576});
  ASSERT_TRUE(depth);
  EXPECT_NEAR(depth->matrix(0, 2), 0.512 * 1024 - 192 - 0.5, 1e-9);
  EXPECT_NEAR(depth->matrix(1, 2), 0.494 * 1024 - 180 - 0.5, 1e-9);
  EXPECT_FALSE(depthCamera(calibration, {640, 480}));
}

}  // namespace
}  // namespace hapticast::server
