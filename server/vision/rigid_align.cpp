// SPDX-License-Identifier: MIT
#include "server/vision/rigid_align.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr int kFinestSide_px = 220;  // objects that are larger are looked at in fewer pixels
constexpr int kCoarsestSide_px = 24;
constexpr std::size_t kPoints = 1500;
constexpr std::size_t kFewestPoints = 40;
constexpr std::size_t kOutlinePoints = 100;
constexpr std::size_t kFewestOutline = 8;
constexpr float kNearEdge_px = 2.0F;
constexpr float kDeeper_px = 8.0F;
constexpr double kOnward = 1.2;  // of the step between these two, measured on a ball
constexpr int kRounds = 8;
constexpr double kDone_px = 0.002;
constexpr double kGrayFloor = 1.5;  // grey levels: what agrees as well as that is not told apart
constexpr double kDepthFloor_mm = 0.7;
constexpr double kTukey = 4.6;        // of a standard deviation
constexpr double kGrayInlier = 30.0;  // grey levels
constexpr double kDepthInlier_mm = 25.0;
constexpr double kDepthReach_mm = 80.0;  // beyond the object's depths: not the object
constexpr double kSpinPrior_rad = 0.05;  // where nothing shows a rotation it goes on as it was
constexpr double kWellFound = 0.6;       // share of inliers: no search needed
constexpr double kFound = 0.5;

// What the alignment reads of a picture at one place.
struct Texel {
  float gray, gray_u, gray_v;
  float depth, depth_u, depth_v;  // depth 0: not known
};

// Part of a picture on one level: its pixel (0, 0) covers factor x factor pixels from `origin`.
struct Window {
  cv::Point origin;
  int factor = 1;
  int columns = 0, rows = 0;
  std::vector<Texel> texels;

  // Position on this level (pixel centres at whole numbers) of a place in the picture (centres at
  // +0.5).
  [[nodiscard]] Eigen::Vector2d place(double u_px, double v_px) const {
    return {(u_px - origin.x) / factor - 0.5, (v_px - origin.y) / factor - 0.5};
  }
};

cv::Mat shrunk(const cv::Mat& image, int factor) {
  if (factor == 1) return image;
  cv::Mat out;
  cv::resize(image, out, {image.cols / factor, image.rows / factor}, 0, 0, cv::INTER_AREA);
  return out;
}

// Depth where `known` (0 / 255), smoothed over what is known; 0 where too little is.
cv::Mat smoothedDepth(const cv::Mat& depth, const cv::Mat& known, int factor) {
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat weighted = shrunk(depth.mul(weight), factor);
  weight = shrunk(weight, factor);
  cv::GaussianBlur(weighted, weighted, {7, 7}, 1.5);
  cv::GaussianBlur(weight, weight, {7, 7}, 1.5);
  cv::Mat out;
  cv::divide(weighted, cv::max(weight, 1e-6), out);
  out.setTo(0.0, weight < 0.4);
  return out;
}

cv::Mat smoothedGray(const cv::Mat& gray, int factor) {
  cv::Mat out;
  shrunk(gray, factor).convertTo(out, CV_32F);
  cv::GaussianBlur(out, out, {5, 5}, 1.0);
  return out;
}

// `area` is cut to whole level pixels.
Window windowOf(const View& view, const cv::Rect& area, int factor, const DepthRange& depths) {
  Window out;
  out.origin = area.tl();
  out.factor = factor;
  const cv::Rect whole(area.x, area.y, area.width / factor * factor, area.height / factor * factor);
  if (whole.width < 3 * factor || whole.height < 3 * factor) return out;
  const cv::Mat gray = smoothedGray(view.gray(whole), factor);
  const cv::Mat raw = view.depth(whole);
  const cv::Mat known =
      (raw > depths.near_mm - kDepthReach_mm) & (raw < depths.far_mm + kDepthReach_mm) & (raw > 0);
  const cv::Mat depth = smoothedDepth(raw, known, factor);
  out.columns = gray.cols;
  out.rows = gray.rows;
  out.texels.resize(gray.total());
  for (int v = 0; v < gray.rows; ++v) {
    const int above = std::max(0, v - 1);
    const int below = std::min(gray.rows - 1, v + 1);
    for (int u = 0; u < gray.cols; ++u) {
      const int left = std::max(0, u - 1);
      const int right = std::min(gray.cols - 1, u + 1);
      Texel& texel = out.texels[static_cast<std::size_t>(v * gray.cols + u)];
      texel.gray = gray.at<float>(v, u);
      texel.gray_u = 0.5F * (gray.at<float>(v, right) - gray.at<float>(v, left));
      texel.gray_v = 0.5F * (gray.at<float>(below, u) - gray.at<float>(above, u));
      const float here = depth.at<float>(v, u);
      const float l = depth.at<float>(v, left), r = depth.at<float>(v, right);
      const float a = depth.at<float>(above, u), b = depth.at<float>(below, u);
      const bool whole_cross = here > 0 && l > 0 && r > 0 && a > 0 && b > 0;
      texel.depth = whole_cross ? here : 0.0F;
      texel.depth_u = whole_cross ? 0.5F * (r - l) : 0.0F;
      texel.depth_v = whole_cross ? 0.5F * (b - a) : 0.0F;
    }
  }
  return out;
}

// Bilinear; false outside. Depth is 0 where one of the four neighbours has none.
bool sample(const Window& window, const Eigen::Vector2d& at, Texel& out) {
  const double u = std::floor(at.x());
  const double v = std::floor(at.y());
  if (!(u >= 0 && v >= 0 && u + 1 < window.columns && v + 1 < window.rows)) return false;
  const auto a = static_cast<float>(at.x() - u);
  const auto b = static_cast<float>(at.y() - v);
  const Texel* row =
      &window.texels[static_cast<std::size_t>(v) * static_cast<std::size_t>(window.columns) +
                     static_cast<std::size_t>(u)];
  const Texel& p = row[0];
  const Texel& q = row[1];
  const Texel& r = row[window.columns];
  const Texel& s = row[window.columns + 1];
  const float wp = (1 - a) * (1 - b), wq = a * (1 - b), wr = (1 - a) * b, ws = a * b;
  const auto mix = [&](float Texel::*field) {
    return wp * p.*field + wq * q.*field + wr * r.*field + ws * s.*field;
  };
  out = {mix(&Texel::gray), mix(&Texel::gray_u), mix(&Texel::gray_v), 0, 0, 0};
  if (p.depth > 0 && q.depth > 0 && r.depth > 0 && s.depth > 0) {
    out.depth = mix(&Texel::depth);
    out.depth_u = mix(&Texel::depth_u);
    out.depth_v = mix(&Texel::depth_v);
  }
  return true;
}

double spreadOf(std::vector<float>& absolute, double floor) {
  if (absolute.empty()) return floor;
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return std::max(floor, 1.48 * static_cast<double>(*middle));
}

double tukey(double residual, double sigma) {
  const double x = residual / (kTukey * sigma);
  if (std::abs(x) >= 1.0) return 0.0;
  const double y = 1.0 - x * x;
  return y * y / (sigma * sigma);
}

Matrix3d rotationOf(const Vector3d& turn_rad) {
  const double angle = turn_rad.norm();
  if (angle < 1e-12) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn_rad / angle).toRotationMatrix();
}

// One object point as it is seen with the present estimate.
struct Seen {
  Vector3d position_mm;
  Texel texel;
  double gray_residual = 0.0;
  double depth_residual_mm = 0.0;
  bool valid = false;
};

struct Normal {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  void add(const Vector6d& row, double residual, double weight) {
    matrix.noalias() += weight * row * row.transpose();
    right.noalias() -= weight * residual * row;
  }
};

// Rows of the two residuals with respect to (shift, turn about the pivot).
void addPoint(const Seen& seen, const Vector3d& pivot, const CameraModel& camera, int factor,
              double gray_sigma, double depth_sigma, Normal& normal) {
  const Vector3d& x = seen.position_mm;
  const double inverse = 1.0 / x.z();
  const double fu = camera.fx_px * inverse / factor;
  const double fv = camera.fy_px * inverse / factor;
  const Vector3d du(fu, 0.0, -fu * x.x() * inverse);
  const Vector3d dv(0.0, fv, -fv * x.y() * inverse);
  const Vector3d arm = x - pivot;
  const auto row = [&](const Vector3d& gradient) {
    Vector6d out;
    out << gradient, arm.cross(gradient);
    return out;
  };
  const Texel& texel = seen.texel;
  const double gray_weight = tukey(seen.gray_residual, gray_sigma);
  if (gray_weight > 0) {
    normal.add(row(double(texel.gray_u) * du + double(texel.gray_v) * dv), seen.gray_residual,
               gray_weight);
  }
  if (texel.depth <= 0) return;
  const double depth_weight = tukey(seen.depth_residual_mm, depth_sigma);
  if (depth_weight <= 0) return;
  normal.add(row(double(texel.depth_u) * du + double(texel.depth_v) * dv - Vector3d::UnitZ()),
             seen.depth_residual_mm, depth_weight);
}

}  // namespace

RigidTemplate::RigidTemplate(const cv::Mat& gray, const Surface& surface, const CameraModel& camera)
    : camera_(camera), box_(surface.box) {
  const int side = std::max(box_.width, box_.height);
  const int finest = std::max(1, (side + kFinestSide_px - 1) / kFinestSide_px);
  const cv::Mat known = surface.mask & (surface.depth > 0);
  if (cv::countNonZero(known) < static_cast<int>(kFewestPoints)) return;
  double near_mm = 0;
  double far_mm = 0;
  cv::minMaxLoc(surface.depth, &near_mm, &far_mm, nullptr, nullptr, known);
  depth_ = {near_mm, far_mm};
  addLevel(gray, surface, finest);
  addLevel(gray, surface, 2 * finest);
  if (levels_[0].points.size() < kFewestPoints) levels_.clear();
  if (!levels_.empty() && outline_mm_.size() < kFewestOutline) {
    for (const Point& point : levels_[0].points) outline_mm_.push_back(point.position_mm);
  }
  coarse_.factor = std::max(1, (side + kCoarsestSide_px - 1) / kCoarsestSide_px);
  const int f = coarse_.factor;
  coarse_.box_px = {box_.x / f, box_.y / f, box_.width / f, box_.height / f};
  const cv::Size size = coarse_.box_px.size();
  if (size.empty()) return;
  cv::resize(gray(box_), coarse_.gray, size, 0, 0, cv::INTER_AREA);
  cv::resize(surface.mask, coarse_.mask, size, 0, 0, cv::INTER_AREA);
  cv::resize(surface.depth, coarse_.depth, size, 0, 0, cv::INTER_NEAREST);
}

void RigidTemplate::addLevel(const cv::Mat& gray, const Surface& surface, int factor) {
  Level level;
  level.factor = factor;
  const cv::Size size(box_.width / factor * factor, box_.height / factor * factor);
  if (size.width >= 3 * factor && size.height >= 3 * factor) {
    const cv::Rect part({0, 0}, size);
    const cv::Mat smooth_gray = smoothedGray(gray(cv::Rect(box_.tl(), size)), factor);
    const cv::Mat known = surface.mask(part) & (surface.depth(part) > 0);
    const cv::Mat depth = smoothedDepth(surface.depth(part), known, factor);
    cv::Mat inside = shrunk(known, factor) > 250;
    if (levels_.empty()) addOutline(inside, depth, factor);
    inside = erodedBy(inside, 2);
    const auto count = static_cast<std::size_t>(cv::countNonZero(inside));
    const int step = std::max(1, static_cast<int>(std::sqrt(double(count) / kPoints) + 0.7));
    for (int v = 1; v < inside.rows - 1; v += step) {
      for (int u = 1; u < inside.cols - 1; u += step) {
        if (inside.at<uchar>(v, u) == 0) continue;
        const auto z = static_cast<double>(depth.at<float>(v, u));
        if (z <= 0) continue;
        level.points.push_back({positionOf(u, v, z, factor), smooth_gray.at<float>(v, u)});
      }
    }
  }
  levels_.push_back(std::move(level));
}

Vector3d RigidTemplate::positionOf(int u, int v, double depth_mm, int factor) const {
  const double u_px = box_.x + factor * (u + 0.5);
  const double v_px = box_.y + factor * (v + 0.5);
  return {(u_px - camera_.cx_px) / camera_.fx_px * depth_mm,
          (v_px - camera_.cy_px) / camera_.fy_px * depth_mm, depth_mm};
}

// A body curves away towards its outline, where depth cannot be read any more: it goes on as the
// square root of the distance to the outline, as a ball's does.
void RigidTemplate::addOutline(const cv::Mat& inside, const cv::Mat& depth, int factor) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(inside, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::Mat distance;
  cv::distanceTransform(inside, distance, cv::DIST_L2, 3);
  const cv::Rect whole(1, 1, inside.cols - 2, inside.rows - 2);
  std::size_t total = 0;
  for (const auto& contour : contours) total += contour.size();
  const std::size_t step = std::max<std::size_t>(1, total / kOutlinePoints);
  for (const auto& contour : contours) {
    for (std::size_t i = 0; i < contour.size(); i += step) {
      const cv::Point& edge = contour[i];
      if (!whole.contains(edge)) continue;
      const cv::Point2f inward(
          distance.at<float>(edge.y, edge.x + 1) - distance.at<float>(edge.y, edge.x - 1),
          distance.at<float>(edge.y + 1, edge.x) - distance.at<float>(edge.y - 1, edge.x));
      const double length = cv::norm(inward);
      if (length < 0.1) continue;
      const auto depthAt = [&](float px) {
        const cv::Point at(cv::Point2f(edge) + inward * (px / static_cast<float>(length)));
        return whole.contains(at) ? static_cast<double>(depth.at<float>(at)) : 0.0;
      };
      const double near_edge = depthAt(kNearEdge_px);
      const double deeper = depthAt(kDeeper_px);
      if (near_edge <= 0 || deeper <= 0) continue;
      const double at_edge = near_edge + kOnward * (near_edge - deeper);
      outline_mm_.push_back(positionOf(edge.x, edge.y, at_edge, factor));
    }
  }
}

cv::Rect RigidTemplate::whereWith(const Vector3d& pivot_mm, const RigidStep& step,
                                  const cv::Size& picture) const {
  const Vector3d to = pivot_mm + step.shift_mm;
  const double scale = std::clamp(pivot_mm.z() / std::max(1.0, to.z()), 0.5, 2.0);
  const double du = camera_.fx_px * (to.x() / to.z() - pivot_mm.x() / pivot_mm.z());
  const double dv = camera_.fy_px * (to.y() / to.z() - pivot_mm.y() / pivot_mm.z());
  const int factor = levels_.back().factor;
  const int margin = 8 * factor + static_cast<int>((std::abs(scale - 1.0) + 0.08) *
                                                   std::max(box_.width, box_.height));
  const double reach = 4.0 * picture.width;
  cv::Rect moved = box_ + cv::Point(static_cast<int>(std::lround(std::clamp(du, -reach, reach))),
                                    static_cast<int>(std::lround(std::clamp(dv, -reach, reach))));
  moved = cv::Rect(moved.x - margin, moved.y - margin, moved.width + 2 * margin,
                   moved.height + 2 * margin);
  return moved & cv::Rect({0, 0}, picture);
}

RigidStep RigidTemplate::align(const View& view, const Vector3d& pivot_mm,
                               const RigidStep& guess) const {
  RigidStep now = guess;
  now.inliers = 0.0;
  const cv::Rect area = whereWith(pivot_mm, guess, view.gray.size());
  const Eigen::AngleAxisd guessed(guess.rotation);
  const Vector3d expected_turn = guessed.angle() * guessed.axis();
  std::vector<Seen> seen;
  std::vector<float> off_gray;
  std::vector<float> off_depth;
  for (std::size_t l = levels_.size(); l-- > 0;) {
    const Level& level = levels_[l];
    const DepthRange depths{depth_.near_mm + std::min(0.0, guess.shift_mm.z()),
                            depth_.far_mm + std::max(0.0, guess.shift_mm.z())};
    const Window window = windowOf(view, area, level.factor, depths);
    if (window.texels.empty() || level.points.size() < kFewestPoints / 2) continue;
    seen.resize(level.points.size());
    for (int round = 0; round < kRounds; ++round) {
      off_gray.clear();
      off_depth.clear();
      double bias = 0.0;
      std::size_t count = 0;
      const Vector3d pivot = pivot_mm + now.shift_mm;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        Seen& s = seen[i];
        s.position_mm = now.rotation * (level.points[i].position_mm - pivot_mm) + pivot;
        const Vector3d& x = s.position_mm;
        s.valid = x.z() > 1.0 && sample(window,
                                        window.place(camera_.fx_px * x.x() / x.z() + camera_.cx_px,
                                                     camera_.fy_px * x.y() / x.z() + camera_.cy_px),
                                        s.texel);
        if (!s.valid) continue;
        s.gray_residual = double(s.texel.gray) - double(level.points[i].gray);
        s.depth_residual_mm = double(s.texel.depth) - x.z();
        if (std::abs(s.gray_residual) < kGrayInlier) {
          bias += s.gray_residual;
          ++count;
        }
      }
      bias = count > 0 ? bias / double(count) : 0.0;  // the light may have changed
      std::size_t agree = 0;
      for (Seen& s : seen) {
        if (!s.valid) continue;
        s.gray_residual -= bias;
        off_gray.push_back(static_cast<float>(std::abs(s.gray_residual)));
        const bool known = s.texel.depth > 0;
        if (known) off_depth.push_back(static_cast<float>(std::abs(s.depth_residual_mm)));
        if (std::abs(s.gray_residual) < kGrayInlier && known &&
            std::abs(s.depth_residual_mm) < kDepthInlier_mm)
          ++agree;
      }
      now.inliers = double(agree) / double(seen.size());
      const double gray_sigma = spreadOf(off_gray, kGrayFloor);
      const double depth_sigma = spreadOf(off_depth, kDepthFloor_mm);
      Normal normal;
      for (const Seen& s : seen) {
        if (s.valid) addPoint(s, pivot, camera_, level.factor, gray_sigma, depth_sigma, normal);
      }
      const Eigen::AngleAxisd turned(now.rotation);
      const Vector3d off_turn = turned.angle() * turned.axis() - expected_turn;
      const double prior = 1.0 / (kSpinPrior_rad * kSpinPrior_rad);
      normal.matrix.diagonal().tail<3>().array() += prior;
      normal.right.tail<3>() -= prior * off_turn;
      normal.matrix.diagonal().head<3>().array() += 1e-6;
      const Vector6d change = normal.matrix.ldlt().solve(normal.right);
      if (!change.allFinite()) return guess;
      now.shift_mm += change.head<3>();
      now.rotation = rotationOf(change.tail<3>()) * now.rotation;
      const double moved_px = change.head<3>().norm() * camera_.fx_px / std::max(1.0, pivot.z());
      if (moved_px < kDone_px * level.factor) break;
    }
  }
  return now;
}

RigidStep RigidTemplate::searched(const View& view, const Vector3d& pivot_mm) const {
  RigidStep out;
  const cv::Size size = coarse_.box_px.size();
  if (size.empty() || coarse_.gray.empty()) return out;
  const int f = coarse_.factor;
  const int reach = 5 * std::max(size.width, size.height) / 2;
  const cv::Rect all(0, 0, view.gray.cols / f, view.gray.rows / f);
  const cv::Rect area = cv::Rect(coarse_.box_px.x - reach, coarse_.box_px.y - reach,
                                 size.width + 2 * reach, size.height + 2 * reach) &
                        all;
  if (area.width < size.width || area.height < size.height) return out;
  const cv::Rect fine(area.x * f, area.y * f, area.width * f, area.height * f);
  cv::Mat gray;
  cv::Mat depth;
  cv::resize(view.gray(fine), gray, area.size(), 0, 0, cv::INTER_AREA);
  cv::resize(view.depth(fine), depth, area.size(), 0, 0, cv::INTER_NEAREST);
  double best = 0.0;
  cv::Point at;
  for (int v = 0; v + size.height <= area.height; ++v) {
    for (int u = 0; u + size.width <= area.width; ++u) {
      double sum = 0;
      for (int j = 0; j < size.height; j += 2) {
        for (int i = 0; i < size.width; i += 2) {
          if (coarse_.mask.at<uchar>(j, i) < 200) continue;
          const int off = std::abs(gray.at<uchar>(v + j, u + i) - coarse_.gray.at<uchar>(j, i));
          const float z = depth.at<float>(v + j, u + i);
          const float off_depth = z > 0 ? std::abs(z - coarse_.depth.at<float>(j, i)) : 60.0F;
          // What is alike counts for it; what is not counts nothing.
          sum += std::max(0.0, 1.0 - off / 40.0) * std::max(0.0, 1.0 - double(off_depth) / 60.0);
        }
      }
      if (sum <= best) continue;
      best = sum;
      at = {u + area.x, v + area.y};
    }
  }
  if (best <= 0) return out;
  out.shift_mm = {(at.x - coarse_.box_px.x) * f * pivot_mm.z() / camera_.fx_px,
                  (at.y - coarse_.box_px.y) * f * pivot_mm.z() / camera_.fy_px, 0.0};
  return out;
}

RigidStep RigidTemplate::find(const View& view, const Vector3d& pivot_mm,
                              const RigidStep& guess) const {
  RigidStep best = guess;
  if (levels_.empty()) return best;
  best = align(view, pivot_mm, guess);
  if (best.inliers < kWellFound) {
    RigidStep start = searched(view, pivot_mm);
    start.rotation = guess.rotation;
    const RigidStep other = align(view, pivot_mm, start);
    if (other.inliers > best.inliers) best = other;
  }
  best.reliable = best.inliers >= kFound;
  // The similarity nearest to what the outline did.
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Vector3d& x : outline_mm_) {
    const Vector3d y = best.rotation * (x - pivot_mm) + pivot_mm + best.shift_mm;
    const double u = camera_.fx_px * x.x() / x.z() + camera_.cx_px - 0.5;
    const double v = camera_.fy_px * x.y() / x.z() + camera_.cy_px - 0.5;
    const Eigen::Vector4d ru(u, -v, 1, 0);
    const Eigen::Vector4d rv(v, u, 0, 1);
    matrix += ru * ru.transpose() + rv * rv.transpose();
    right += ru * (camera_.fx_px * y.x() / y.z() + camera_.cx_px - 0.5) +
             rv * (camera_.fy_px * y.y() / y.z() + camera_.cy_px - 0.5);
  }
  const Eigen::Vector4d s = matrix.ldlt().solve(right);
  if (s.allFinite()) best.similarity = {s[0], -s[1], s[2], s[1], s[0], s[3]};
  return best;
}

}  // namespace hapticast::server
