// SPDX-License-Identifier: MIT
// Vision: makes frames that can be touched of images with depth. Source reads every source of
// hapticast-server.
//
// Contract
// - Images are borrowed for the time of the call. Colour has 8 bits a channel, in the order R, G,
// B.
//   Depth is in mm along the optical axis, and 0 where it was not measured.
// - Points. The middle of pixel (u, v) is the point (u + 0.5, v + 0.5).
// - Delay. The motion of a frame depends on later frames too, so push() returns a frame some frames
//   later. flush() returns the last ones.
// - Errors of a source are std::runtime_error, those of settings and images std::invalid_argument.
// - Log. Warnings about files and cameras go to the default logger of spdlog, which belongs to the
//   program: spdlog::set_level(spdlog::level::off) silences it.
// - Threads. Each object has one thread at a time. OpenCV uses more of its own.
//
// Example: the objects of a clip.
//
//   hapticast::Source source("synthetic:bounce");
//   hapticast::Vision vision(source);
//   while (const auto images = source.read())
//     if (const auto frame = vision.push(*images))
//       std::printf("%.2f s: %zu objects\n", frame->time_s, frame->objects.size());
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

/// Images of one instant. `rgb` may be empty: no picture. `mask` may be empty: no mask. Either is
/// empty in all images of a Vision, or in none.
struct Images {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;   ///< height_px x width_px x 3
  std::vector<float> depth;        ///< height_px x width_px; mm (see SourceInfo::metric)
  std::vector<std::uint8_t> mask;  ///< height_px x width_px; 0: outside, n: object n
  double time_s = 0.0;             ///< rises from images to images
  std::uint32_t epoch = 0;         ///< another value: nothing continues the images before
  std::uint64_t index = 0;         ///< number in the clip, which Source sets; yours may all be 0
};

/// Properties of a source of images.
struct SourceInfo {
  std::string name = {};     ///< for people
  int width_px = 0;          ///< 16..1920 of your images
  int height_px = 0;         ///< 16..1080 of your images
  double fps = 25.0;         ///< frames/s, 1..240
  bool metric = true;        ///< depth is in mm; false: 0..255, and 255 is nearest
  bool live = false;         ///< a camera or a stream, which has no end
  std::uint64_t frames = 0;  ///< number of frames; 0: unknown
  /// Pinhole camera, px; absent: unknown.
  struct Camera {
    double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  };
  std::optional<Camera> camera = {};
};

/// A recorded clip or a live camera.
class Source {
 public:
  /// Opens `spec`, the value of --source of hapticast-server: synthetic:NAME, a folder, a file,
  /// COLOUR,DEPTH, a camera or the address of a live stream. `fps` > 0 replaces its rate. Errors:
  /// std::runtime_error.
  explicit Source(const std::string& spec, double fps = 0.0);
  ~Source();
  Source(Source&& from) noexcept;
  Source& operator=(Source&& from) noexcept;

  [[nodiscard]] const SourceInfo& info() const;
  /// Returns the next images; nullopt at the end. Of a live source it waits for them, and their
  /// time is that since the opening. Errors: std::runtime_error.
  [[nodiscard]] std::optional<Images> read();
  /// Begins the clip again. The times continue, and the epoch is another one. Errors:
  /// std::runtime_error (the source is live).
  void rewind();

  class Impl;

 private:
  friend class Vision;
  std::unique_ptr<Impl> impl_;
};

struct VisionSettings {
  /// Points (u, v) on objects in the first images, px; empty: the nearest compact object.
  std::vector<std::pair<double, double>> objects = {};
  std::vector<std::pair<double, double>> not_objects = {};  ///< points that are on no object, px
  bool thesis = false;                                      ///< true: the methods of the thesis
  bool motion = true;                                       ///< false: no motion is measured
  bool low_latency = false;                                 ///< true: one frame of delay
  bool pictures = true;  ///< true: frames have the picture, as JPEG
  std::optional<std::pair<double, double>> map_range =
      {};                              ///< depths that become depth_mm and 0, mm
  std::optional<double> fov_deg = {};  ///< horizontal field of view, 10..170
  Object::Material material = {};      ///< of all objects
};

class Vision {
 public:
  /// For images of your own, which pass once: the first ones with an object set the range of the
  /// depths. Errors: std::invalid_argument.
  explicit Vision(const SourceInfo& info, const VisionSettings& settings = {});
  /// For all images of `source`, in their order. A recorded clip is read once to find the range of
  /// its depths and its motion, and then rewound. `source` need not outlive this object. Errors:
  /// std::invalid_argument, std::runtime_error.
  explicit Vision(Source& source, const VisionSettings& settings = {});
  ~Vision();
  Vision(Vision&& from) noexcept;
  Vision& operator=(Vision&& from) noexcept;

  /// Returns the properties of the frames, for a Publisher or a Renderer. They are complete after
  /// the first frame.
  [[nodiscard]] StreamInfo info() const;
  /// Adds images, and returns the frame that is complete now; nullopt: none yet. Errors:
  /// std::invalid_argument (sizes that do not match, a value that is not finite, a time that does
  /// not rise; the images are not added), std::invalid_argument (no object at a point of
  /// VisionSettings::objects) and std::runtime_error; after these two the next images begin anew.
  [[nodiscard]] std::optional<Frame> push(const Images& images);
  /// Returns the frames that push() has not returned yet, oldest first.
  [[nodiscard]] std::vector<Frame> flush();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
