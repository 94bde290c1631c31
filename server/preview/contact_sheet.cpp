// SPDX-License-Identifier: MIT
#include "server/preview/contact_sheet.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "server/preview/picture_axes.hpp"
#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr int kText_px = 22;  // a line of text; chosen
constexpr int kLeastPanel_px =
    480;                            // width of a panel of the first frame: two fit the text; chosen
constexpr int kMostPanel_px = 960;  // likewise; chosen
constexpr int kColumns = 6;         // columns of a sheet
constexpr int kThumbnail_px = 240;  // width of a frame in a sheet; chosen
constexpr int kAround_px = 8;       // margin around the relief; chosen
constexpr double kLetters = 0.45;   // font size for kText_px

// BGR colours that are distinct on most pictures and for colour-blind people (Okabe and Ito 2008).
const std::array<cv::Scalar, 4> kColors{cv::Scalar(66, 228, 240), cv::Scalar(233, 180, 86),
                                        cv::Scalar(167, 121, 204), cv::Scalar(115, 158, 0)};

void write(cv::Mat& picture, const std::string& text, const cv::Point& at, const cv::Scalar& color,
           double size = kLetters) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
}

// Breaks a line at the width of the picture.
std::vector<std::string> breakLine(const std::string& line, int width_px) {
  std::vector<std::string> out;
  std::string now;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::string word = line.substr(at, end - at);
    std::string longer = now.empty() ? word : fmt::format("{} {}", now, word);
    int base_px = 0;
    const int long_px =
        cv::getTextSize(longer, cv::FONT_HERSHEY_SIMPLEX, kLetters, 1, &base_px).width;
    if (long_px > width_px && !now.empty()) {
      out.push_back(now);
      longer = word;
    }
    now = longer;
    at = end + 1;
  }
  out.push_back(now);
  return out;
}

// Returns the slope of the heights along one axis in mm/mm. One-sided where a neighbour is outside.
float computeSlope(const cv::Mat& heights, const cv::Point& at, const cv::Point& step,
                   float px_mm) {
  const cv::Rect all({0, 0}, heights.size());
  const float here = heights.at<float>(at);
  const auto heightAt = [&](const cv::Point& there) {
    if (!all.contains(there)) return here;
    const float height = heights.at<float>(there);
    return std::isnan(height) ? here : height;
  };
  return (heightAt(at + step) - heightAt(at - step)) / (2.0F * px_mm);
}

// Returns a part of a picture, enlarged to the size of the picture.
cv::Mat enlargePart(const cv::Mat& picture, const cv::Rect& part) {
  cv::Mat out = cv::Mat::zeros(picture.size(), picture.type());
  if (part.empty()) return out;
  const double scale =
      std::min(double(picture.cols) / part.width, double(picture.rows) / part.height);
  const cv::Size size(std::min(picture.cols, static_cast<int>(scale * part.width)),
                      std::min(picture.rows, static_cast<int>(scale * part.height)));
  const cv::Rect place({(picture.cols - size.width) / 2, (picture.rows - size.height) / 2}, size);
  cv::Mat into = out(place);
  cv::resize(picture(part), into, size, 0, 0, cv::INTER_LINEAR);
  return out;
}

cv::Rect findBoxOfObjects(const PreviewFrame& frame) {
  cv::Rect box;
  for (const HapticObject& object : frame.haptic.objects) {
    if (!object.relief) continue;
    const auto& rect = object.relief->rect;
    box |= cv::Rect(rect.u, rect.v, rect.width, rect.height);
  }
  return box;
}

// Draws the author's points, --object as a green cross and --not as a red one that is tilted.
void drawPoints(cv::Mat& picture, const cv::Rect& part, const std::vector<AuthorPoint>& points,
                bool on_object) {
  const double scale = double(picture.cols) / part.width;
  const int size = picture.cols > kThumbnail_px ? 17 : 9;
  const int type = on_object ? cv::MARKER_CROSS : cv::MARKER_TILTED_CROSS;
  const cv::Scalar color = on_object ? cv::Scalar(90, 255, 90) : cv::Scalar(80, 80, 255);
  for (const AuthorPoint& point : points) {
    const cv::Point at_px(static_cast<int>(point.at_px.x()), static_cast<int>(point.at_px.y()));
    if (!part.contains(at_px)) continue;
    const cv::Point at = computePixelPlace(at_px, part, scale);
    cv::drawMarker(picture, at, {0, 0, 0}, type, size + 2, size > 9 ? 4 : 3);
    cv::drawMarker(picture, at, color, type, size, size > 9 ? 2 : 1);
  }
}

// Returns the points whose time is nearest to that of frame `index`.
std::vector<AuthorPoint> selectPoints(const std::vector<AuthorPoint>& points,
                                      const std::vector<PreviewFrame>& frames, std::size_t index) {
  std::vector<AuthorPoint> out;
  for (const AuthorPoint& point : points) {
    const auto nearest = std::min_element(
        frames.begin(), frames.end(), [&point](const PreviewFrame& a, const PreviewFrame& b) {
          return std::abs(a.time_s - point.time_s) < std::abs(b.time_s - point.time_s);
        });
    if (nearest - frames.begin() == static_cast<std::ptrdiff_t>(index)) out.push_back(point);
  }
  return out;
}

// Returns a part of the first frame with outlines, the points of its time, and axes.
cv::Mat drawPanel(const PreviewFrame& frame, const VisionSettings& settings, const cv::Rect& part,
                  const cv::Size& size) {
  const auto at_start = [](const std::vector<AuthorPoint>& points) {
    std::vector<AuthorPoint> out;
    std::copy_if(points.begin(), points.end(), std::back_inserter(out),
                 [](const AuthorPoint& point) { return point.time_s == 0.0; });
    return out;
  };
  cv::Mat picture = drawOutlined(frame, part, size);
  cv::Mat with_axes = drawAxes(picture, part, frame.own_px);
  cv::Mat inside = with_axes(cv::Rect({kAxisLeft_px, kAxisTop_px}, size));
  drawPoints(inside, part, at_start(settings.not_points), false);
  drawPoints(inside, part, at_start(settings.object_points), true);
  return with_axes;
}

// Returns the text in lines below `picture`.
cv::Mat addText(const cv::Mat& picture, const std::vector<std::string>& lines) {
  std::vector<std::string> text;
  for (const std::string& line : lines) {
    for (std::string& part : breakLine(line, picture.cols - 16)) text.push_back(std::move(part));
  }
  const int below_px = kText_px * static_cast<int>(text.size()) + 10;
  cv::Mat out;
  cv::copyMakeBorder(picture, out, 0, below_px, 0, 0, cv::BORDER_CONSTANT, {40, 40, 40});
  for (std::size_t i = 0; i < text.size(); ++i)
    write(out, text[i], {8, picture.rows + kText_px * static_cast<int>(i + 1)}, {255, 255, 255});
  return out;
}

}  // namespace

cv::Mat drawOutlined(const PreviewFrame& frame, const cv::Rect& part, const cv::Size& size) {
  cv::Mat picture;
  const bool enlarges = size.width > part.width;
  cv::resize(frame.color(part), picture, size, 0, 0, enlarges ? cv::INTER_LINEAR : cv::INTER_AREA);
  const int width_px = std::max(1, size.width / 400);
  for (const std::uint32_t id : listIds(frame.haptic)) {
    cv::Mat mask;
    cv::resize(renderMask(frame.haptic, id, frame.color.size())(part), mask, size, 0, 0,
               cv::INTER_NEAREST);
    std::vector<std::vector<cv::Point>> outline;
    cv::findContours(mask, outline, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    if (size.width > kThumbnail_px)
      cv::drawContours(picture, outline, -1, {0, 0, 0}, width_px + 2, cv::LINE_8);
    cv::drawContours(picture, outline, -1, kColors[id % kColors.size()], width_px, cv::LINE_8);
    const cv::Moments moments = cv::moments(mask, true);
    if (moments.m00 <= 0.0 || size.width <= kThumbnail_px) continue;
    const cv::Point middle(static_cast<int>(moments.m10 / moments.m00),
                           static_cast<int>(moments.m01 / moments.m00));
    write(picture, std::to_string(id), middle, kColors[id % kColors.size()], size.width / 640.0);
  }
  return picture;
}

cv::Mat drawRelief(const PreviewFrame& frame, const Workspace& workspace) {
  const cv::Mat heights = renderHeights(frame.haptic, frame.color.size());
  const Vec2 px_mm = workspace.mmPerPixel();
  const cv::Vec3f light = cv::normalize(cv::Vec3f(-0.5F, -0.6F, 0.8F));  // u right, v down
  cv::Mat picture = cv::Mat::zeros(heights.size(), CV_8UC3);
  for (int v = 0; v < heights.rows; ++v) {
    for (int u = 0; u < heights.cols; ++u) {
      const cv::Point at(u, v);
      if (std::isnan(heights.at<float>(at))) continue;
      const float du = computeSlope(heights, at, {1, 0}, static_cast<float>(px_mm.x()));
      const float dv = computeSlope(heights, at, {0, 1}, static_cast<float>(px_mm.y()));
      const float lit = cv::normalize(cv::Vec3f(-du, -dv, 1.0F)).dot(light);
      picture.at<cv::Vec3b>(at) =
          cv::Vec3b::all(cv::saturate_cast<unsigned char>(30.0F + 225.0F * std::max(0.0F, lit)));
    }
  }
  return enlargePart(picture, findBoxAround(heights >= 0.0, kAround_px));  // false for NaN
}

cv::Mat drawFirst(const PreviewFrame& frame, const Workspace& workspace,
                  const VisionSettings& settings, const std::vector<std::string>& lines) {
  const cv::Rect whole({0, 0}, frame.color.size());
  const int width_px = std::clamp(whole.width, kLeastPanel_px, kMostPanel_px);
  const cv::Size size(width_px, std::max(1, whole.height * width_px / whole.width));
  std::vector<cv::Mat> panels{drawPanel(frame, settings, whole, size)};
  const cv::Rect near = selectCloseUp(findBoxOfObjects(frame), whole.size());
  if (near != whole) panels.push_back(drawPanel(frame, settings, near, size));
  cv::Mat relief;
  cv::resize(drawRelief(frame, workspace), relief, size, 0, 0, cv::INTER_LINEAR);
  cv::Mat framed;
  cv::copyMakeBorder(relief, framed, kAxisTop_px, 0, 0, 0, cv::BORDER_CONSTANT, {40, 40, 40});
  panels.push_back(framed);
  cv::Mat all;
  cv::hconcat(panels, all);
  return addText(all, lines);
}

cv::Mat drawCandidates(const std::vector<PreviewFrame>& candidates,
                       const VisionSettings& settings) {
  const cv::Size of = candidates.front().color.size();
  cv::Rect box;
  for (const PreviewFrame& candidate : candidates) box |= findBoxOfObjects(candidate);
  const cv::Rect shown = selectCloseUp(box, of);
  const cv::Size each(kLeastPanel_px, std::max(1, kLeastPanel_px * of.height / of.width));
  std::vector<cv::Mat> panels;
  panels.reserve(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    cv::Mat panel = drawOutlined(candidates[i], shown, each);
    drawPoints(panel, shown, settings.object_points, true);
    write(panel, fmt::format("#{}", i + 1), {8, 28}, {255, 255, 255}, 2 * kLetters);
    panels.push_back(panel);
  }
  cv::Mat all;
  cv::hconcat(panels, all);
  return all;
}

cv::Mat drawContactSheet(const std::vector<PreviewFrame>& frames, const VisionSettings& settings) {
  const cv::Size of = frames.front().color.size();
  cv::Rect box;
  for (const PreviewFrame& frame : frames) box |= findBoxOfObjects(frame);
  const cv::Rect shown = selectCloseUp(box, of);
  const cv::Size each(kThumbnail_px, std::max(1, kThumbnail_px * of.height / of.width));
  const int columns = std::min(kColumns, static_cast<int>(frames.size()));
  const int rows = (static_cast<int>(frames.size()) + columns - 1) / columns;
  cv::Mat sheet(rows * each.height, columns * each.width, CV_8UC3, cv::Scalar::all(40));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int n = static_cast<int>(i);
    cv::Mat part = sheet(cv::Rect({n % columns * each.width, n / columns * each.height}, each));
    drawOutlined(frames[i], shown, each).copyTo(part);
    drawPoints(part, shown, selectPoints(settings.not_points, frames, i), false);
    drawPoints(part, shown, selectPoints(settings.object_points, frames, i), true);
    const bool lost = frames[i].haptic.objects.empty();
    write(part, fmt::format("{:.2f} s{}", frames[i].time_s, lost ? " lost" : ""), {6, 16},
          lost ? cv::Scalar(80, 80, 255) : cv::Scalar(255, 255, 255));
  }
  return sheet;
}

}  // namespace hapticast::server
