// SPDX-License-Identifier: MIT
// The readers of JSON files from outside, meta.json, BOP's scene_camera.json and a Kinect's
// calibration: any text is read or refused with a SourceError, and what is read is in its range.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/source/folder/bop_scene.hpp"
#include "server/source/folder/clip_meta.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/scale/kinect_calibration.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::json {
namespace {

using namespace hapticast::server;

void readMeta(std::string_view text) {
  const ClipMeta meta = parseClipMeta(text, "file.json");
  require(!meta.fps || (*meta.fps >= 1.0 && *meta.fps <= 240.0));
  require(!meta.mm_per_unit || (*meta.mm_per_unit > 0.0 && *meta.mm_per_unit < 1001.0));
  require(!meta.depth_bits || *meta.depth_bits == 8 || *meta.depth_bits == 16);
  require(!meta.camera || (meta.camera->fx_px >= 1.0 && meta.camera->fy_px >= 1.0));
}

void readScene(std::string_view text) {
  for (const auto& [image, camera] : parseSceneCamera(text, "file.json")) {
    require(camera.mm_per_unit >= 1e-3 && camera.mm_per_unit <= 1e3);
    require(camera.camera.fx_px >= 1.0 && camera.camera.fy_px >= 1.0);
  }
}

void readCalibration(std::string_view text) {
  const KinectCalibration calibration = parseKinectCalibration(text, "file.json");
  require(!calibration.depth.sensor.empty() && calibration.color.fx > 0.0);
  require(std::abs(cv::determinant(calibration.rotation)) < 1.1);
  const auto camera = depthCamera(calibration, {320, 288});
  require(camera && camera->matrix(0, 0) > 1.0);
}

}  // namespace

HAPTICAST_FUZZ_TARGET("json") {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const auto& read : {readMeta, readScene, readCalibration}) {
    try {
      read(text);
    } catch (const SourceError& error) {
      const std::string_view line = error.what();
      require(line.starts_with("file.json:") && line.find('\n') == std::string_view::npos);
    }
  }
  return 0;
}

}  // namespace hapticast::fuzz::json
