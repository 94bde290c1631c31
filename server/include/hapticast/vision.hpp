// SPDX-License-Identifier: MIT
// Vision makes frames from images with depth: objects that can be touched, and their motion. Source
// reads every source of hapticast-server.
//
// Contract
// - Images. Colour has 8 bits a channel, in the order R, G, B. Vision keeps no reference to the
//   images of the caller. A mask of the images replaces VisionSettings::objects.
// - Points. The middle of pixel (u, v) is the point (u + 0.5, v + 0.5).
// - Delay. The motion of a frame depends on later frames too, so push() returns a frame some frames
//   later. flush() returns the last ones.
// - Log. Warnings about files and cameras go to the default logger of spdlog, which belongs to the
//   program: spdlog::set_level(spdlog::level::off) silences it.
// - Threads. Each object has one thread at a time. OpenCV uses more of its own.
// - Errors, units and axes: frame.hpp.
//
// Example: publish the objects of a clip in its own time (publisher.hpp).
//
//   hapticast::Source source("synthetic:bounce");
//   hapticast::Vision vision(source);
//   hapticast::Publisher publisher({.info = vision.info()});
//   while (const auto images = source.read()) {
//     if (const auto frame = vision.push(*images)) publisher.publish(*frame);
//     std::this_thread::sleep_for(std::chrono::milliseconds(40));
//   }
//   for (const hapticast::Frame& frame : vision.flush()) publisher.publish(frame);
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hapticast/frame.hpp"

namespace hapticast {

/// Images of one instant, of one size. `rgb` may be empty: no picture. `mask` may be empty: no
/// mask. Each of the two is empty in all images of a Vision, or in none.
struct Images {
  int width_px = 0;                ///< as SourceInfo::width_px
  int height_px = 0;               ///< as SourceInfo::height_px
  std::vector<std::uint8_t> rgb;   ///< height_px x width_px x 3
  std::vector<float> depth;        ///< height_px x width_px; unit: SourceInfo::metric
  std::vector<std::uint8_t> mask;  ///< height_px x width_px; 0: outside, n: object n
  double time_s = 0.0;             ///< rises from images to images
  std::uint32_t epoch = 0;         ///< another value: these images continue nothing (a cut)
  std::uint64_t index = 0;         ///< number in the clip; Source sets it, others leave it at 0
};

/// Properties of a source of images.
struct SourceInfo {
  std::string name = {};  ///< for people, UTF-8, at most 256 bytes
  int width_px = 0;       ///< width of the images, 16..1920
  int height_px = 0;      ///< height of the images, 16..1080
  double fps = 25.0;      ///< frames/s, 1..240
  /// True: depth is in mm along the optical axis, and 0 where it was not measured. False: depth is
  /// 0 (farthest) to 255 (nearest), and all values are valid.
  bool metric = true;
  bool live = false;         ///< true: a camera or a stream, which has no end
  std::uint64_t frames = 0;  ///< number of frames; 0: unknown
  /// Pinhole camera: focal lengths and principal point, px. The middle of the first pixel is (0.5,
  /// 0.5).
  struct Camera {
    double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  };
  std::optional<Camera> camera = {};  ///< absent: unknown
};

/// A recorded clip or a live camera.
class Source {
 public:
  /// Opens `spec`, a value of --source of hapticast-server: "synthetic:bounce", "my_clip" (a
  /// folder), "clip.mkv", "color.mp4,depth.mkv", "camera:0,1" or "rtsp://host/live".
  /// server/source/README.md has them all. `fps` replaces the frame rate of the source,
  /// frames/s, 1..240; 0: its own. Errors: std::runtime_error (also for a wrong `spec`).
  explicit Source(const std::string& spec, double fps = 0.0);
  ~Source();
  Source(Source&& from) noexcept;
  Source& operator=(Source&& from) noexcept;

  /// Returns the properties of the source.
  [[nodiscard]] const SourceInfo& info() const;
  /// Returns the next images, or nullopt at the end. For a live source the function waits for them.
  /// Images::time_s counts from the opening of the source. Errors: std::runtime_error.
  [[nodiscard]] std::optional<Images> read();
  /// Begins the clip again. The times continue to rise, and the epoch is another one. Errors:
  /// std::runtime_error (the source is live).
  void rewind();

  class Impl;

 private:
  friend class Vision;
  std::unique_ptr<Impl> impl_;
};

/// Choices for the whole life of a Vision.
struct VisionSettings {
  using Pair = std::pair<double, double>;
  std::vector<Pair> objects = {};      ///< points (u, v) on objects in the first images, px; empty:
                                       ///< the nearest compact object
  std::vector<Pair> not_objects = {};  ///< points (u, v) that are on no object, px
  bool thesis = false;                 ///< true: the methods of the thesis (frame.hpp)
  bool motion = true;                  ///< false: no motion is measured
  bool low_latency = false;  ///< true: one frame of delay; impacts of live sources are not found
  bool pictures = true;      ///< true: frames have the picture, as JPEG
  /// Depths (near, far), mm, that become the heights StreamInfo::depth_mm and 0. Absent: Vision
  /// measures them.
  std::optional<Pair> map_range = {};
  /// Horizontal field of view, degrees, 10..170. It replaces SourceInfo::camera. Without both,
  /// Vision assumes 56 degrees.
  std::optional<double> fov_deg = {};
  Object::Material material = {};  ///< material of all objects
};

/// Vision of one source.
class Vision {
 public:
  /// For images of your own, which Vision sees once. The first images with an object set the range
  /// of the depths. Errors: std::invalid_argument.
  explicit Vision(const SourceInfo& info, const VisionSettings& settings = {});
  /// For the images of `source`. The constructor reads a recorded clip once, to find the range of
  /// its depths and its motion, and rewinds it: images that you have read before come again.
  /// `source` need not outlive this object. Errors: std::invalid_argument, std::runtime_error.
  explicit Vision(Source& source, const VisionSettings& settings = {});
  ~Vision();
  Vision(Vision&& from) noexcept;
  Vision& operator=(Vision&& from) noexcept;

  /// Returns the properties of the frames, for a Publisher or a Renderer. With a recorded source
  /// they are final after the constructor, otherwise after the first frame: make the Publisher
  /// after it.
  [[nodiscard]] StreamInfo info() const;
  /// Adds images. Returns the frame that is complete now, or nullopt if none is. Errors:
  /// std::invalid_argument (sizes that do not match, a value that is not finite, a time that does
  /// not rise; the images are not added), std::runtime_error (no object at a point of
  /// VisionSettings::objects, and other failures; the next images begin a new epoch).
  [[nodiscard]] std::optional<Frame> push(const Images& images);
  /// Returns the frames that push() has not returned yet, oldest first. push() may follow. Errors:
  /// std::runtime_error.
  [[nodiscard]] std::vector<Frame> flush();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
