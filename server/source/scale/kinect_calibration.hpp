// SPDX-License-Identifier: MIT
// Calibration of an Azure Kinect or Orbbec, as recorders attach it to their files: intrinsics of
// the depth and the colour camera, and the rigid transform between them. Thread: any.
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace hapticast::server {

inline constexpr std::size_t kMaxCalibration_bytes = 1U << 20U;

/// Camera with the lens model of Brown and Conrady (rational, 6 parameters). Pixel coordinates
/// follow OpenCV's convention: the centre of the first pixel is (0, 0).
struct LensCamera {
  cv::Matx33d matrix = cv::Matx33d::eye();
  std::array<double, 8> distortion{};  ///< k1, k2, p1, p2, k3, k4, k5, k6: OpenCV's order
  cv::Size size;                       ///< of the picture, px
};

/// Content of calibration.json. Both cameras are normalised: focal lengths and centres are shares
/// of the sensor's width and height, and the origin is the corner of the first pixel.
struct KinectCalibration {
  struct Camera {
    double cx = 0.0, cy = 0.0, fx = 0.0, fy = 0.0;
    std::array<double, 8> distortion{};  ///< as LensCamera
    cv::Size sensor;                     ///< px
  };
  Camera depth;
  Camera color;
  cv::Matx33d rotation;        ///< from the depth camera's frame to the colour camera's
  cv::Vec3d translation_mm{};  ///< from the depth camera's frame to the colour camera's
};

/// Returns the calibration in the text of a calibration.json, a JSON object of at most
/// kMaxCalibration_bytes. Throws SourceError if the text is none. The message is one line that
/// begins with `name`.
[[nodiscard]] KinectCalibration parseKinectCalibration(std::string_view text,
                                                       const std::string& name);

/// Returns the camera of a depth picture of `size`, one of the four modes of the sensor of
/// 1024 x 1024 px: 640x576, 320x288, 1024x1024, 512x512. Returns nullopt for other sizes.
[[nodiscard]] std::optional<LensCamera> depthCamera(const KinectCalibration& calibration,
                                                    cv::Size size);

/// Returns the camera of a colour picture of `size`. The sensor has 4:3. A picture of 16:9 shows
/// its whole width and the middle of its height. Returns nullopt for another aspect ratio.
[[nodiscard]] std::optional<LensCamera> colorCamera(const KinectCalibration& calibration,
                                                    cv::Size size);

}  // namespace hapticast::server
