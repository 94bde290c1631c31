// SPDX-License-Identifier: MIT
// Draws things as a pinhole camera sees them: colour, exact depth, and which thing each pixel
// shows. Rays are followed to the root of the things' own formula. Thread: one.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/source/camera_model.hpp"
#include "tests/scenes/held/paint.hpp"
#include "tests/scenes/held/solid.hpp"

namespace hapticast::evaluate::held {

/// Camera frame throughout: X right, Y down, Z forward, mm.
struct Light {
  Vec3 towards{0.3, -0.8, -0.5};  ///< unit, to the lamp
  Color lamp{1.0F, 1.0F, 1.0F};
  Color around{0.4F, 0.4F, 0.4F};  ///< what comes from everywhere
  Vec3 up{0, -1, 0};               ///< most of it from above
};

/// Why a depth camera may see nothing at a pixel.
enum Blindness : std::uint8_t { kSurface = 1, kGlare = 2, kGrazing = 4 };

/// The picture so far; colours are linear light.
struct Picture {
  cv::Mat depth;    ///< CV_32FC1, mm
  cv::Mat id;       ///< CV_8UC1, Thing::id
  cv::Mat ambient;  ///< CV_32FC3
  cv::Mat direct;   ///< CV_32FC3, of the lamp where nothing is in its way
  cv::Mat blind;    ///< CV_8UC1, Blindness

  [[nodiscard]] Picture clone() const;
};

/// How far along `direction` from `origin` (both in the thing's frame, `direction` of any length)
/// the ray enters the thing; nullopt: it does not before `most`.
std::optional<double> meet(const Thing& thing, const Parts& among, const Vec3& origin,
                           const Vec3& direction, double from, double most);

/// Where the lamp does not reach: distances from it in a square about the middle of the scene.
class Shadows {
 public:
  Shadows(const Light& light, const Vec3& middle_mm);
  void add(const Thing& thing);
  [[nodiscard]] Shadows clone() const;
  /// 0 in the shadow .. 1.
  [[nodiscard]] float litAt(const Vec3& at_mm) const;

 private:
  Vec3 down_, across_, along_;  // from the lamp, and the square's sides
  Vec3 corner_mm_;
  cv::Mat distance_;
};

class Renderer {
 public:
  Renderer(const server::CameraModel& camera, const cv::Size& size, const Light& light)
      : camera_(camera), size_(size), light_(light) {}

  /// Nothing anywhere.
  [[nodiscard]] Picture empty() const;
  /// Into `picture`, where it is nearer than what is there; returns how many pixels it would fill
  /// if nothing were in its way.
  int draw(const Thing& thing, const std::vector<Paint>& paints, Picture& picture) const;
  /// The picture as a camera of this gain per colour records it: CV_8UC3.
  [[nodiscard]] cv::Mat develop(const Picture& picture, const Shadows& shadows,
                                const Color& gain) const;
  [[nodiscard]] const server::CameraModel& camera() const { return camera_; }
  [[nodiscard]] cv::Size size() const { return size_; }

 private:
  void shade(const Thing& thing, const Parts& among, const std::vector<Paint>& paints,
             const cv::Point& px, double z, Picture& picture) const;
  [[nodiscard]] Vec3 rayAt(int u, int v) const { return camera_.ray(u + 0.5, v + 0.5); }

  server::CameraModel camera_;
  cv::Size size_;
  Light light_;
};

}  // namespace hapticast::evaluate::held
