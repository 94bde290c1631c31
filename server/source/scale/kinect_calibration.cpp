// SPDX-License-Identifier: MIT
#include "server/source/scale/kinect_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "common/json/json_document.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/scale/depth_scale.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kParameters = 14;
constexpr int kMostSensor_px = 16384;

/// Returns the text of a member; empty if it is missing.
std::string readText(JsonObject& from, const char* key) {
  const auto* const value = from.read(key);
  return value != nullptr ? jsonText(*value) : "";
}

KinectCalibration::Camera parseLens(JsonObject& camera) {
  JsonObject lens = camera.object("Intrinsics");
  if (readText(lens, "ModelType").find("BrownConrady") == std::string::npos)
    lens.refuse("ModelType", "is another model than BrownConrady");
  // cx, cy, fx, fy, k1..k6, the centre of distortion (0 in this model), p2, p1.
  const std::vector<double> values = lens.numbers("ModelParameters", kParameters, -1e4, 1e4);
  KinectCalibration::Camera out;
  out.cx = values[0];
  out.cy = values[1];
  out.fx = values[2];
  out.fy = values[3];
  out.distortion = {values[4], values[5], values[13], values[12],
                    values[6], values[7], values[8],  values[9]};
  const auto side_px = [&camera](const char* key) {
    return static_cast<int>(camera.number(key, 1.0, kMostSensor_px).value_or(0.0));
  };
  out.sensor = {side_px("SensorWidth"), side_px("SensorHeight")};
  constexpr double kLeastFocal = 0.05;  // chosen: a picture of 168 degrees
  if (out.sensor.empty() || !(out.fx >= kLeastFocal && out.fy >= kLeastFocal))
    throw JsonError(camera.place(), "a camera has no sensor size or focal length");
  return out;
}

/// Transform from the device to a camera: rotation and translation in mm.
struct Placement {
  cv::Matx33d rotation;
  cv::Vec3d translation_mm;
};

Placement parsePlacement(JsonObject& camera) {
  JsonObject members = camera.object("Rt");
  const std::vector<double> rotation = members.numbers("Rotation", 9, -1.01, 1.01);
  const std::vector<double> translation_m = members.numbers("Translation", 3, -10.0, 10.0);
  Placement out;
  out.rotation = cv::Matx33d(rotation.data());
  out.translation_mm = 1000.0 * cv::Vec3d(translation_m.data());
  constexpr double kRigid = 0.01;  // chosen
  if (cv::norm(out.rotation * out.rotation.t() - cv::Matx33d::eye()) > kRigid)
    members.refuse("Rotation", "is no rotation");
  return out;
}

/// Returns the camera of a picture of `size`, which begins at `crop` of a picture of `whole`.
LensCamera cropCamera(const KinectCalibration::Camera& camera, cv::Size whole, cv::Point2d crop,
                      cv::Size size) {
  LensCamera out;
  constexpr double kHalf_px = 0.5;
  out.matrix = {camera.fx * whole.width,
                0.0,
                camera.cx * whole.width - crop.x - kHalf_px,
                0.0,
                camera.fy * whole.height,
                camera.cy * whole.height - crop.y - kHalf_px,
                0.0,
                0.0,
                1.0};
  out.distortion = camera.distortion;
  out.size = size;
  return out;
}

JsonObject& findCamera(std::vector<JsonObject>& cameras, const std::string& purpose) {
  const auto found = std::find_if(cameras.begin(), cameras.end(), [&](JsonObject& camera) {
    return readText(camera, "Purpose") == purpose;
  });
  if (found == cameras.end()) throw JsonError({}, "has no camera of the kind " + purpose);
  return *found;
}

KinectCalibration readCalibration(JsonObject file) {
  constexpr std::size_t kMostCameras = 100;  // chosen
  auto cameras = file.object("CalibrationInformation").objects("Cameras", kMostCameras);
  JsonObject& depth = findCamera(cameras, "CALIBRATION_CameraPurposeDepth");
  JsonObject& color = findCamera(cameras, "CALIBRATION_CameraPurposePhotoVideo");
  KinectCalibration out;
  out.depth = parseLens(depth);
  out.color = parseLens(color);
  const Placement from = parsePlacement(depth);
  const Placement to = parsePlacement(color);
  out.rotation = to.rotation * from.rotation.t();
  out.translation_mm = to.translation_mm - out.rotation * from.translation_mm;
  return out;
}

}  // namespace

KinectCalibration parseKinectCalibration(std::string_view text, const std::string& name) {
  constexpr std::size_t kMostLevels = 32;  // chosen
  try {
    const JsonDocument document = parseJson(text, {kMaxCalibration_bytes, kMostLevels});
    return readCalibration(JsonObject(document));
  } catch (const JsonError& error) {
    throw SourceError(describe(name, error) + "; remove it");
  }
}

std::optional<LensCamera> depthCamera(const KinectCalibration& calibration, cv::Size size) {
  // Each mode: the sensor, whole or with 2 x 2 px as one, and the part of it that it shows.
  struct Mode {
    cv::Size size;
    int sensor_px;
    cv::Point2d crop;
  };
  static const std::array<Mode, 4> kModes{
      Mode{{640, 576}, 1024, {192.0, 180.0}}, Mode{{320, 288}, 512, {96.0, 90.0}},
      Mode{{1024, 1024}, 1024, {0.0, 0.0}}, Mode{{512, 512}, 512, {0.0, 0.0}}};
  const auto* const mode = std::find_if(kModes.begin(), kModes.end(),
                                        [size](const Mode& known) { return known.size == size; });
  if (mode == kModes.end()) return std::nullopt;
  return cropCamera(calibration.depth, {mode->sensor_px, mode->sensor_px}, mode->crop, size);
}

std::optional<LensCamera> colorCamera(const KinectCalibration& calibration, cv::Size size) {
  const cv::Size four_three(4, 3);
  const cv::Size sixteen_nine(16, 9);
  KinectCalibration::Camera camera = calibration.color;
  if (isSameAspect(camera.sensor, sixteen_nine)) {
    // Older calibrations are shares of 16:9, which shows the middle three quarters of the height.
    camera.cy = 0.75 * camera.cy + 0.125;
    camera.fy *= 0.75;
  } else if (!isSameAspect(camera.sensor, four_three)) {
    return std::nullopt;
  }
  if (!isSameAspect(size, four_three) && !isSameAspect(size, sixteen_nine)) return std::nullopt;
  const cv::Size whole(size.width, static_cast<int>(std::lround(0.75 * size.width)));
  return cropCamera(camera, whole, {0.0, 0.5 * (whole.height - size.height)}, size);
}

}  // namespace hapticast::server
