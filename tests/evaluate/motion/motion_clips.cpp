// SPDX-License-Identifier: MIT
// Motion in real captures against the camera's poses: still things, seen by a moving camera, move
// as the poses say. Of the desk two of them: the tags' (published with the clip; they shake by some
// degrees, which the things, that stand before the tags, show as 20 px), and those of the whole
// scene, by corners followed from the first frame without the object's own. Of the office those of
// a motion capture system, while the thing is in the picture.
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/persistence.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <sstream>

#include "server/source/folder/image_sequence.hpp"
#include "server/source/synthetic/synthetic_scene.hpp"
#include "server/vision/motion/savitzky_golay.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/motion/motion_clips.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

// Scene to camera, mm, of every picture; from metres.
std::vector<Eigen::Isometry3d> tagPoses(const std::filesystem::path& file) {
  std::vector<Eigen::Isometry3d> out;
  const cv::FileStorage storage(file.string(),
                                cv::FileStorage::READ | cv::FileStorage::FORMAT_JSON);
  for (const cv::FileNode& matrix : storage["grid"]) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column)
        pose.matrix()(row, column) =
            static_cast<double>(matrix[row][column]) * (column == 3 ? 1e3 : 1);
    }
    out.push_back(pose);
  }
  return out;
}

// The same from lines of `frame times t(3) q(4)`, camera to world, metres.
std::vector<Eigen::Isometry3d> capturedPoses(const std::filesystem::path& file) {
  std::vector<Eigen::Isometry3d> out;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    double skipped = 0;
    Vec3 shift = Vec3::Zero();
    Eigen::Quaterniond turn;
    if (!(words >> skipped >> skipped >> skipped >> shift.x() >> shift.y() >> shift.z() >>
          turn.x() >> turn.y() >> turn.z() >> turn.w()))
      continue;  // the head
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = turn.normalized().matrix();
    pose.translation() = 1e3 * shift;
    out.push_back(pose.inverse());
  }
  return out;
}

// Camera frame of every picture from that of the first, by corners all over the scene but
// `without`.
std::vector<Eigen::Isometry3d> posesFromScene(const std::vector<server::RgbdFrame>& frames,
                                              const server::CameraModel& camera,
                                              const cv::Rect& without) {
  cv::Mat last;
  cv::cvtColor(frames[0].color, last, cv::COLOR_BGR2GRAY);
  cv::Mat wanted = (frames[0].depth > 300) & (frames[0].depth < 2000);
  wanted(without & cv::Rect({0, 0}, wanted.size())).setTo(0);
  std::vector<cv::Point2f> places;
  cv::goodFeaturesToTrack(last, places, 800, 0.005, 8, wanted);
  std::vector<cv::Point3f> points;
  // In OpenCV's coordinates the centres of pixels are whole numbers.
  const cv::Matx33d matrix(camera.fx_px, 0, camera.cx_px - 0.5, 0, camera.fy_px, camera.cy_px - 0.5,
                           0, 0, 1);
  for (const cv::Point2f& at : places) {
    const double z = double(frames[0].depth.at<float>(cvRound(at.y), cvRound(at.x)));
    points.emplace_back(float((double(at.x) - matrix(0, 2)) / matrix(0, 0) * z),
                        float((double(at.y) - matrix(1, 2)) / matrix(1, 1) * z), float(z));
  }
  std::vector<Eigen::Isometry3d> out(1, Eigen::Isometry3d::Identity());
  cv::Vec3d turn(0, 0, 0);
  cv::Vec3d shift(0, 0, 0);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    cv::Mat gray;
    cv::cvtColor(frames[i].color, gray, cv::COLOR_BGR2GRAY);
    std::vector<cv::Point2f> moved;
    std::vector<uchar> found;
    std::vector<float> error;
    cv::calcOpticalFlowPyrLK(last, gray, places, moved, found, error, {21, 21}, 4);
    std::vector<cv::Point2f> back;
    std::vector<uchar> found_back;
    cv::calcOpticalFlowPyrLK(gray, last, moved, back, found_back, error, {21, 21}, 4);
    std::vector<cv::Point3f> kept_points;
    std::vector<cv::Point2f> kept;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      if (found[k] == 0 || found_back[k] == 0 || cv::norm(back[k] - places[k]) > 0.5) continue;
      kept_points.push_back(points[k]);
      kept.push_back(moved[k]);
    }
    cv::Mat inliers;
    cv::solvePnPRansac(kept_points, kept, matrix, cv::noArray(), turn, shift, i > 1, 200, 3.0F,
                       0.999, inliers);
    if (inliers.rows < 60) break;  // from here on these poses are no truth
    // Who has slipped off is forgotten.
    points.clear();
    places.clear();
    for (int k = 0; k < inliers.rows; ++k) {
      const auto index = static_cast<std::size_t>(inliers.at<int>(k));
      points.push_back(kept_points[index]);
      places.push_back(kept[index]);
    }
    cv::solvePnP(points, places, matrix, cv::noArray(), turn, shift, true);
    const Vec3 axis(turn[0], turn[1], turn[2]);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (axis.norm() > 0) pose.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).matrix();
    pose.translation() = Vec3(shift[0], shift[1], shift[2]);
    out.push_back(pose);
    last = gray;
  }
  return out;
}

// Velocities of the point that is at `first` in frame `from`, as a window over the poses gives
// them.
std::vector<Motion> truthOf(const std::vector<Eigen::Isometry3d>& poses,
                            const server::SceneView& view, const Vec3& first_mm, std::size_t from,
                            double fps) {
  const Vec3 on_desk = poses[from].inverse() * first_mm;
  std::vector<server::Sample> samples;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Motion at = view.project(poses[i] * on_desk, Vec3::Zero(), Vec3::Zero());
    samples.push_back({double(i) / fps, at.position_mm, 0.0});
  }
  std::vector<Motion> out;
  const int reach = server::lookaheadFrames(fps);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t first = i > std::size_t(reach) ? i - std::size_t(reach) : 0;
    const std::size_t last = std::min(samples.size() - 1, i + std::size_t(reach));
    const std::vector<server::Sample> window(samples.begin() + std::ptrdiff_t(first),
                                             samples.begin() + std::ptrdiff_t(last) + 1);
    out.push_back(server::computeMotion(window, i - first, reach));
  }
  return out;
}

}  // namespace

void evaluateRealClip(Report& report, const RealObject& object, server::MotionMode mode,
                      const char* variant) {
  const std::filesystem::path clip = test::clipsFolder() / object.clip;
  if (!std::filesystem::exists(clip)) {
    report.leaveOut(object.name);
    return;
  }
  server::ImageSequence source(clip.string(), 0.0);
  const double fps = source.info().fps;
  std::vector<server::RgbdFrame> frames;
  server::VisionSettings settings;
  settings.object_points = {{object.point_px}};
  settings.motion = mode;
  settings.depth_range = object.range;
  server::Vision vision(source.info(), settings);
  std::vector<server::VisionResult> results;
  while (auto frame = source.read()) {
    if (frames.size() == object.frames) break;
    if (auto result = vision.push(*frame, mediaTime(double(frames.size()) / fps)))
      results.push_back(std::move(*result));
    frames.push_back(std::move(*frame));
  }
  for (server::VisionResult& result : vision.flush()) results.push_back(std::move(result));
  const server::CameraModel camera = source.info().camera.value();
  const server::SceneView view{
      .workspace = vision.description().workspace, .camera = camera, .range = object.range};
  constexpr std::size_t kFrom = 5;
  const Vec3 nominal = results.at(kFrom).frame.objects.at(0).motion.position_mm;
  const double z = view.range.far_mm -
                   nominal.z() / view.workspace.depth_mm * (view.range.far_mm - view.range.near_mm);
  const Vec2 image = view.workspace.toImage(nominal.head<2>());
  const Vec3 first = z * camera.ray(image.x(), image.y());
  const PixelRect box = results[0].frame.objects.at(0).relief->rect;
  const cv::Rect without(box.u - 10, box.v - 10, box.width + 20, box.height + 20);
  const bool usual = mode == server::MotionMode::kRgbd;
  const auto compare = [&](const std::vector<Eigen::Isometry3d>& poses, const std::string& stage) {
    const std::vector<Motion> truth = truthOf(poses, view, first, kFrom, fps);
    double v2 = 0, a2 = 0, truth_v2 = 0, truth_a2 = 0;
    for (std::size_t i = kFrom; i + kFrom < std::min(results.size(), truth.size()); ++i) {
      if (results[i].frame.objects.empty()) continue;
      const Motion& motion = results[i].frame.objects[0].motion;
      v2 += (motion.velocity_mm_s - truth[i].velocity_mm_s).squaredNorm();
      truth_v2 += truth[i].velocity_mm_s.squaredNorm();
      a2 += (motion.acceleration_mm_s2 - truth[i].acceleration_mm_s2).squaredNorm();
      truth_a2 += truth[i].acceleration_mm_s2.squaredNorm();
    }
    report.add({object.name, stage + "_velocity", variant, 100 * std::sqrt(v2 / truth_v2), "%", 0,
                usual, false});
    report.add({object.name, stage + "_acceleration", variant, 100 * std::sqrt(a2 / truth_a2), "%",
                0, usual, false});
  };
  if (std::filesystem::exists(clip / "poses.txt")) {
    compare(capturedPoses(clip / "poses.txt"), "office_by_capture");
  } else {
    compare(tagPoses(clip / "camera_pose_apriltag.json"), "desk_by_tags");
    compare(posesFromScene(frames, camera, without), "desk_by_scene");
  }
}

}  // namespace hapticast::evaluate
