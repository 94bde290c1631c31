// SPDX-License-Identifier: MIT
#include "server/preview/picture_axes.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace hapticast::server {

namespace {

constexpr double kMargin = 1.5;      // chosen: width of a close-up in widths of the objects
constexpr double kMostEnlarged = 8;  // chosen: pixels stay recognisable
constexpr double kLargest = 0.5;     // chosen, of the picture: a larger part is no close-up
constexpr int kLeastStep_px = 60;    // chosen, drawn: the numbers do not touch
constexpr int kNumber_px = 32;       // width of a number of four digits
constexpr int kTick_px = 5;          // chosen, drawn
constexpr double kGrid = 0.25;       // chosen: opacity of the grid
constexpr double kNumbers = 0.4;     // size of the font
const cv::Scalar kPaper = cv::Scalar::all(40);
const cv::Scalar kInk = cv::Scalar::all(230);

void writeNumber(cv::Mat& picture, int number, const cv::Point& at) {
  cv::putText(picture, std::to_string(number), at, cv::FONT_HERSHEY_SIMPLEX, kNumbers, kInk, 1,
              cv::LINE_AA);
}

/// One axis of a drawn picture, which shows the pixels of the own pictures from `from_px` on.
struct Axis {
  double from_px;
  double end_px;
  double scale;  // drawn px for each own one
  int step;

  /// Returns the axis of the pixels from `begin` on, `count` of them, drawn with `scale`.
  static Axis of(int begin, int count, double scale, double own_px) {
    return {begin * own_px, (begin + count) * own_px, scale / own_px, tickStep_px(scale / own_px)};
  }
  [[nodiscard]] int firstTick() const { return static_cast<int>(std::ceil(from_px / step)) * step; }
  [[nodiscard]] int computePlace(int tick) const {
    return static_cast<int>((tick + 0.5 - from_px) * scale);
  }
};

}  // namespace

cv::Rect selectCloseUp(const cv::Rect& box, const cv::Size& picture) {
  const cv::Rect whole({0, 0}, picture);
  if (box.empty()) return whole;
  const double side =
      std::max(double(box.width) / picture.width, double(box.height) / picture.height);
  const double share = std::max(kMargin * side, 1.0 / kMostEnlarged);
  if (share > kLargest) return whole;
  const cv::Size size(std::max(1, int(share * picture.width)),
                      std::max(1, int(share * picture.height)));
  const cv::Point middle(box.x + box.width / 2, box.y + box.height / 2);
  return {std::clamp(middle.x - size.width / 2, 0, picture.width - size.width),
          std::clamp(middle.y - size.height / 2, 0, picture.height - size.height), size.width,
          size.height};
}

int tickStep_px(double scale) {
  for (int power = 1;; power *= 10) {
    for (const int factor : {1, 2, 5}) {
      if (factor * power * scale >= kLeastStep_px) return factor * power;
    }
  }
}

cv::Point computePixelPlace(const cv::Point& at_px, const cv::Rect& part, double scale) {
  return {static_cast<int>((at_px.x + 0.5 - part.x) * scale),
          static_cast<int>((at_px.y + 0.5 - part.y) * scale)};
}

cv::Mat drawAxes(const cv::Mat& drawn, const cv::Rect& part, const Vec2& own_px) {
  const double scale = double(drawn.cols) / part.width;
  const Axis across = Axis::of(part.x, part.width, scale, own_px.x());
  const Axis down = Axis::of(part.y, part.height, scale, own_px.y());
  cv::Mat lines = drawn.clone();
  cv::Mat out;
  cv::copyMakeBorder(drawn, out, kAxisTop_px, 0, kAxisLeft_px, 0, cv::BORDER_CONSTANT, kPaper);
  for (int u = across.firstTick(); u < across.end_px; u += across.step) {
    const int at = across.computePlace(u);
    cv::line(lines, {at, 0}, {at, drawn.rows}, {255, 255, 255});
    cv::line(out, {kAxisLeft_px + at, kAxisTop_px - kTick_px}, {kAxisLeft_px + at, kAxisTop_px - 1},
             kInk);
    const int text_u = std::min(kAxisLeft_px + at - 10, out.cols - kNumber_px);
    writeNumber(out, u, {text_u, kAxisTop_px - kTick_px - 4});
  }
  for (int v = down.firstTick(); v < down.end_px; v += down.step) {
    const int at = down.computePlace(v);
    cv::line(lines, {0, at}, {drawn.cols, at}, {255, 255, 255});
    cv::line(out, {kAxisLeft_px - kTick_px, kAxisTop_px + at}, {kAxisLeft_px - 1, kAxisTop_px + at},
             kInk);
    writeNumber(out, v, {4, kAxisTop_px + at + 4});
  }
  cv::Mat inside = out(cv::Rect({kAxisLeft_px, kAxisTop_px}, drawn.size()));
  cv::addWeighted(drawn, 1.0 - kGrid, lines, kGrid, 0.0, inside);
  return out;
}

}  // namespace hapticast::server
