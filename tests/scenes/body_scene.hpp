// SPDX-License-Identifier: MIT
// Scenes that vision is measured on: bodies on exact paths before a pinhole camera, with the truth
// of every frame, seen through a sensor that may be noisy, coarse, misaligned. Deterministic.
// Thread: one.
//
// Frames and units as in server/source/synthetic/synthetic_scene.hpp: camera X right, Y down, Z
// forward, mm.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/source/synthetic/synthetic_scene.hpp"
#include "tests/scenes/drawn_source.hpp"
#include "tests/scenes/sensor.hpp"

namespace hapticast::evaluate {

enum class Shape : std::uint8_t { kEllipsoid, kBox };

/// Where a body is at any time; exact derivatives.
using Path = std::function<server::BodyState(double time_s)>;

struct Body {
  Shape shape = Shape::kEllipsoid;
  Vec3 half_size_mm{100, 100, 100};  ///< semi-axes, or half edges
  Path path;
  bool is_object = true;  ///< part of what is to be touched; else in its way (a hand, a bar)
  bool textured = true;
  cv::Vec3f dark{30, 60, 140}, light{130, 215, 250};  ///< BGR of its texture
};

struct TestScene {
  std::string name;
  std::vector<Body> bodies;
  double duration_s = 3.0;
  server::DepthRange range{600.0, 1300.0};
  bool table = false;  ///< a table seen at 35 degrees, through (0, 0, 1000); else a wall at 1250 mm
  double pan_px = 0.0;       ///< the camera swings by this to either side, in px of a width of 640:
  double pan_hz = 0.0;       ///< everything moves right by pan_px sin(2 pi pan_hz t)
  bool blur = false;         ///< half a frame of exposure
  bool same_colors = false;  ///< the background has the first body's colours
  std::vector<double> impacts_s;
};

/// Plays a scene through a sensor. The workspace is the default one (160 x 120 mm) of this size.
class TestSource final : public server::test::DrawnSource {
 public:
  TestSource(TestScene scene, Sensor sensor, double fps, bool give_mask, int width_px = 640,
             int height_px = 480, std::uint64_t seed = 1);

  /// Both draw a frame once between them from now on: one scene through several sensors. Same
  /// scene, rate and size; the pictures stay in memory.
  void sharePictures(TestSource& other);

  /// Truth of frame `index`: motion of the first object body's centre (nominal mm, position and
  /// velocity in the picture, acceleration against the background), its mask (0 / 255), depth (mm),
  /// and the share of it that is seen.
  struct Truth {
    Motion centre;
    cv::Mat mask;
    cv::Mat depth;
    double visible_fraction = 1.0;
  };
  [[nodiscard]] Truth truth(std::uint64_t index) const;
  [[nodiscard]] Motion centreAt(double time_s) const;
  [[nodiscard]] const server::SceneView& view() const { return view_; }
  [[nodiscard]] const TestScene& scene() const { return scene_; }

 private:
  struct Picture {
    cv::Mat color;           // CV_8UC3
    cv::Mat depth;           // CV_32FC1
    cv::Mat body;            // CV_8UC1, 1 + index of the visible body
    double object_px = 0.0;  // of the object without what is in its way
  };
  [[nodiscard]] double panAt_px(double time_s) const;
  [[nodiscard]] double panSpeedAt_px_s(double time_s) const;
  server::RgbdFrame draw(std::uint64_t index) override;
  [[nodiscard]] Picture drawAt(double time_s, bool color) const;
  [[nodiscard]] Picture drawFrame(std::uint64_t index) const;
  void drawBackground(double time_s, bool color, Picture& out) const;
  void drawBody(const Body& body, std::size_t index, double time_s, bool color, Picture& out) const;
  [[nodiscard]] cv::Mat maskOf(const Picture& picture) const;
  [[nodiscard]] cv::Mat drawColor(const Picture& picture, double time_s, cv::RNG& random) const;

  TestScene scene_;
  Sensor sensor_;
  bool give_mask_;
  std::uint64_t seed_;
  server::SceneView view_;
  server::SolidNoise noise_;
  Picture background_;                                        // where it does not move
  std::shared_ptr<std::map<std::uint64_t, Picture>> shared_;  // by frame; null: drawn anew
  SensorState sensor_state_;
};

/// The scenes for motion, and those for masks and reliefs.
std::vector<TestScene> motionScenes();
std::vector<TestScene> segmentationScenes();

}  // namespace hapticast::evaluate
