// SPDX-License-Identifier: MIT
// Clips in memory with the truth of every frame, and what segmenters make of them: for the topic
// `vision`, which runs every variant on the same frames.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/vision/vision.hpp"
#include "tests/scenes/body_scene.hpp"

namespace hapticast::evaluate {

struct NamedSensor {
  const char* name;
  Sensor sensor;
};
/// The sensors that masks and reliefs are measured through: rs0 and rs4 (stereo, depth 0 or 4 px
/// beside colour), tof2 (time of flight, 2 px), b8 (8 bits). Colour went through JPEG.
std::vector<NamedSensor> sensors();

struct Clip {
  std::string scene;
  std::string sensor;
  server::SourceInfo info;
  std::vector<server::RgbdFrame> frames;  ///< with the exact mask, for who asks for it
  std::vector<TestSource::Truth> truth;
  std::vector<Vec3> centre;  ///< u, v (px) and depth (mm) of the object's centre in each frame

  [[nodiscard]] std::string name() const { return scene + "/" + sensor; }
};

struct ClipSize {
  int width_px = 640;
  int height_px = 480;
  std::size_t frames = 40;
};

/// The scene drawn once and seen by each sensor, at 25 frames per second.
std::vector<Clip> renderClips(const TestScene& scene, const std::vector<NamedSensor>& sensors,
                              const ClipSize& size);

/// Centroid of a mask, px, pixel centres at +0.5.
Vec2 centroidOf_px(const cv::Mat& mask);

/// Thread time per frame, us. `relief` and `clean` together are enhance.
struct StageTimes {
  double view = 0, track = 0, segment = 0, clean = 0, relief = 0;

  [[nodiscard]] double segmentation() const { return track + segment; }
  [[nodiscard]] double enhancement() const { return clean + relief; }
  [[nodiscard]] double total() const { return view + segmentation() + enhancement(); }
};

struct MaskRun {
  std::vector<cv::Mat> masks;  ///< per frame; empty where there was no object
  double start_us = 0.0;       ///< segmentation of the first frame
  StageTimes times;            ///< mean of the other frames
};
/// Segments and enhances a clip, stage by stage as Tracker does; the object is given by its true
/// centroid in the first frame.
MaskRun runSegmenter(const Clip& clip, server::SegmentMode mode, Method method);

struct MaskErrors {
  double mask = 0.0;     ///< mean of 1 - IoU; 1 where there was no object
  double worst = 0.0;    ///< of the frames, their 95 % quantile
  double first = 0.0;    ///< of the first frame
  double flicker = 0.0;  ///< share of the object's area whose error changes from frame to frame
  std::size_t lost = 0;  ///< frames
};
MaskErrors errorsOf(const MaskRun& run, const Clip& clip);

}  // namespace hapticast::evaluate
