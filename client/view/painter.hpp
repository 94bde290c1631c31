// SPDX-License-Identifier: MIT
// Drawing functions for the video with the HIP and the forces. Window, film and screenshot use
// them.
// Thread: any (pure functions).
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/view/relief_shape.hpp"

namespace hapticast::client {

// Colours, BGR.
inline const cv::Scalar kGroundColor(28, 26, 24);
inline const cv::Scalar kTextColor(215, 212, 208);
inline const cv::Scalar kForceColor(64, 214, 255);
inline const cv::Scalar kStaticForceColor(255, 120, 64);
inline const cv::Scalar kDynamicForceColor(48, 56, 255);
inline const cv::Scalar kContactColor(120, 255, 90);
inline const cv::Scalar kGapColor(230, 215, 190);
inline const cv::Scalar kConeColor(190, 205, 70);

/// Position of the stream's picture in an image or in the window. The picture is as large as
/// possible at its aspect ratio. Points are in px of the image or of the window.
class ScenePlace {
 public:
  /// Places the picture in the middle of the rectangle with the upper left corner `corner` and the
  /// size `room`.
  ScenePlace(const Workspace& workspace, const Vec2& corner, const Vec2& room);

  [[nodiscard]] const Workspace& workspace() const { return workspace_; }
  [[nodiscard]] const Vec2& corner() const { return corner_; }
  /// Returns the lower right corner.
  [[nodiscard]] Vec2 end() const;
  /// Returns width and height.
  [[nodiscard]] Vec2 size() const { return end() - corner_; }
  [[nodiscard]] bool contains(const Vec2& point) const;
  /// Return the point at which the image shows a position. The position is nominal (x, y), or in px
  /// of the stream's picture. The point is finite, and at most 10,000 px away from the corner.
  [[nodiscard]] Vec2 fromNominal(const Vec2& nominal_mm) const;
  [[nodiscard]] Vec2 fromImage(const Vec2& image_px) const;
  /// Returns the nominal (x, y) of a point.
  [[nodiscard]] Vec2 toNominal(const Vec2& point) const;
  /// Returns the arrow for a force, px. Its length is the magnitude of the force: one newton has
  /// the same length in every direction. Its direction is that of the oblique projection: x to the
  /// right, y up, z up and a little to the right. The projection of a force along the viewing
  /// direction is a point; its arrow then has the direction of z.
  [[nodiscard]] Vec2 arrow(const Vec3& force_N) const;
  [[nodiscard]] double pixelsPerMm() const { return scale_ * workspace_.pixelsPerMm().x(); }

 private:
  Workspace workspace_;
  double scale_;  // px per px of the stream's picture
  Vec2 corner_;
};

/// Returns the factor (0..1) between the rendered force and the sum of the static and the dynamic
/// force before the safety chain.
[[nodiscard]] double renderedShare(const TickReport& report);

/// Returns `picture` (CV_8UC3), scaled to `size`. Returns a dark background if `picture` is empty.
[[nodiscard]] cv::Mat fitPicture(const cv::Mat& picture, cv::Size size);

/// Draws the HIP as a cone and the contact as a ring into `image` (CV_8UC3). The force at the
/// device is a solid arrow. The rendered shares of the static and the dynamic force are dashed
/// arrows. Before contact, the HIP is drawn above the spot that it would touch, and a line leads to
/// that spot. Also draws the target of the pointer, if it is known. A HIP beside the picture is
/// drawn at the picture's edge.
void drawTouch(cv::Mat& image, const ScenePlace& place, const TickReport& report,
               const PointerTarget& pointer = {});

/// Draws the cells of `mesh` over the picture in `image` (CV_8UC3).
void drawShade(cv::Mat& image, const ScenePlace& place, const ReliefMesh& mesh);

/// Draws closed lines into `image` (CV_8UC3). `lines` is in px of the stream's picture.
void drawOutlines(cv::Mat& image, const ScenePlace& place,
                  const std::vector<std::vector<cv::Point2f>>& lines);

/// The meaning of a mark that drawTouch() draws.
struct Legend {
  const char* text;
  cv::Scalar color;         ///< BGR
  bool of_pointer = false;  ///< true: drawn only if a pointer moves the HIP
};
/// The legend of window, film and screenshot.
inline const std::array<Legend, 7> kLegend{{{"yellow arrow: force at the device", kForceColor},
                                            {"blue, dashed: its static share", kStaticForceColor},
                                            {"red, dashed: its dynamic share", kDynamicForceColor},
                                            {"green ring: contact", kContactColor},
                                            {"cone: its tip touches the object", kConeColor},
                                            {"line: height above the object", kGapColor},
                                            {"white ring: pointer", cv::Scalar::all(255), true}}};

inline constexpr double kLabelSize = 0.45;  ///< OpenCV's font scale of small text

/// Draws a line of text into `image`. `at` (px) is the lower left corner of the text. `size` is
/// OpenCV's font scale.
void drawLabel(cv::Mat& image, const std::string& text, cv::Point at, const cv::Scalar& color,
               double size = kLabelSize);
/// Returns the width of a small text, px.
[[nodiscard]] int labelWidth_px(const std::string& text);

}  // namespace hapticast::client
