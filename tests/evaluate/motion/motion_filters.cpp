// SPDX-License-Identifier: MIT
#include "tests/evaluate/motion/motion_filters.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "server/vision/motion/clip_smoother.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/savitzky_golay.hpp"
#include "server/vision/tracker.hpp"
#include "tests/evaluate/thread_time.hpp"

namespace hapticast::evaluate {

namespace {

using server::MotionMode;
using server::Sample;

// Savitzky-Golay: acceleration of the polynomial through samples at - before .. at + after.
Vec3 fitted(const std::vector<Sample>& s, std::size_t at, std::size_t before, std::size_t after,
            int order) {
  const std::size_t count = before + after + 1;
  Eigen::MatrixXd powers(count, order + 1);
  Eigen::MatrixXd right(count, 3);
  const double step_s = s[at].time_s - s[at - 1].time_s;
  for (std::size_t i = 0; i < count; ++i) {
    const Sample& sample = s[at - before + i];
    for (int k = 0; k <= order; ++k)
      powers(Eigen::Index(i), k) = std::pow((sample.time_s - s[at].time_s) / step_s, k);
    right.row(Eigen::Index(i)) = (sample.position_mm - s[at].position_mm).transpose();
  }
  const Eigen::MatrixXd c = powers.colPivHouseholderQr().solve(right);
  return 2.0 * c.row(2).transpose() / (step_s * step_s);
}

struct Filter {
  const char* name;
  std::size_t before, after;
  int order;
};
constexpr Filter kFilters[] = {{"backward difference", 2, 0, 2}, {"central difference", 1, 1, 2},
                               {"SG 5, order 2", 2, 2, 2},       {"SG 7, order 4", 3, 3, 4},
                               {"SG 9, order 4", 4, 4, 4},       {"SG 11, order 4", 5, 5, 4},
                               {"SG 15, order 4", 7, 7, 4}};

std::vector<Sample> posesOf(const TestSource& source, const std::vector<server::RgbdFrame>& clip,
                            MotionMode mode) {
  server::VisionSettings settings;
  settings.motion = mode;
  std::uint32_t ids = 1;
  server::ClipAnnotations annotations;
  server::Tracker tracker(source.info(), settings, nullptr, ids, annotations);
  const server::NominalFrame nominal{source.view().workspace, source.view().range};
  std::vector<Sample> out;
  for (const server::RgbdFrame& frame : clip) {
    const double time_s = double(frame.index) / source.info().fps;
    const auto objects = tracker.next(frame, time_s);
    if (!objects.empty()) out.push_back(nominal.sample(objects[0].pose, time_s));
  }
  return out;
}

}  // namespace

void evaluateFilters(Report& report, const std::string& name, const TestSource& source,
                     const std::vector<server::RgbdFrame>& clip) {
  struct Estimator {
    const char* name;
    MotionMode mode;
  };
  const int reach = server::lookaheadFrames(source.info().fps);
  for (const Estimator& estimator :
       {Estimator{"rgbd", MotionMode::kRgbd}, Estimator{"lk", MotionMode::kLk}}) {
    const std::vector<Sample> poses = posesOf(source, clip, estimator.mode);
    constexpr std::size_t kMargin = 8;
    if (poses.size() < 3 * kMargin) continue;
    const auto measure = [&](const std::string& filter, bool usual, bool thesis,
                             const auto& acceleration, double before_us = 0.0) {
      double off = 0, truth2 = 0;
      const double start_us = threadTime_us();
      for (std::size_t i = kMargin; i + kMargin < poses.size(); ++i) {
        const Vec3 truth = source.centreAt(poses[i].time_s).acceleration_mm_s2;
        off += (acceleration(i) - truth).squaredNorm();
        truth2 += truth.squaredNorm();
      }
      const double time_us =
          before_us + (threadTime_us() - start_us) / double(poses.size() - 2 * kMargin);
      report.add({name, "acceleration_filter", std::string(estimator.name) + ", " + filter,
                  100 * std::sqrt(off / truth2), "%", time_us, usual, thesis});
    };
    for (const Filter& filter : kFilters) {
      measure(filter.name, false, false, [&](std::size_t i) {
        return fitted(poses, i, filter.before, filter.after, filter.order);
      });
    }
    measure("ours", estimator.mode == MotionMode::kRgbd, false, [&](std::size_t i) {
      const std::size_t first = i - std::size_t(reach);
      const std::vector<Sample> window(poses.begin() + std::ptrdiff_t(first),
                                       poses.begin() + std::ptrdiff_t(i) + reach + 1);
      return server::computeMotion(window, std::size_t(reach), reach).acceleration_mm_s2;
    });
    const double start_us = threadTime_us();
    const std::vector<Motion> whole = server::smoothTrack(poses, {}, reach);
    const double whole_us = (threadTime_us() - start_us) / double(poses.size());
    measure(
        "whole clip", false, false, [&](std::size_t i) { return whole[i].acceleration_mm_s2; },
        whole_us);
    // Eq. 5 as printed: velocity over the haptic step of 1 ms.
    measure("Eq. 5 literal", false, true, [&](std::size_t i) {
      return Vec3((poses[i].position_mm - poses[i - 1].position_mm) * source.info().fps / 1e-3);
    });
  }
}

}  // namespace hapticast::evaluate
