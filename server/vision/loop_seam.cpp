// SPDX-License-Identifier: MIT
#include "server/vision/loop_seam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticast::server {

namespace {

// Returns the way of the object's outermost point, mm.
double moved_mm(const TrackedObject& before, const TrackedObject& now,
                const NominalFrame& nominal) {
  const Sample a = nominal.sample(before.pose, 0.0);
  const Sample b = nominal.sample(now.pose, 0.0);
  const cv::Size size = now.surface.box.size();
  const double radius_mm =
      0.5 * std::hypot(size.width, size.height) * nominal.workspace.mmPerPixel().maxCoeff();
  return (b.position_mm - a.position_mm).norm() + std::abs(b.angle_rad - a.angle_rad) * radius_mm;
}

// Returns the change of force at a fingertip that the change of relief causes, N.
double reliefChange_N(const TrackedObject& before, const TrackedObject& now,
                      const NominalFrame& nominal, const VisionSettings& settings) {
  if (now.atRest()) return 0.0;
  const auto reliefOf = [&](const TrackedObject& object) {
    return makeRelief(object.surface, nominal.range, nominal.workspace, settings.method);
  };
  const auto a = reliefOf(before);
  const auto b = reliefOf(now);
  if (a->rect != b->rect || a->mask != b->mask) return std::numeric_limits<double>::infinity();
  return forceDifference_N(*a, *b, nominal.workspace.mmPerPixel().x(), settings.stiffness_N_mm());
}

}  // namespace

bool haveSameObjects(const std::vector<TrackedObject>& a, const std::vector<TrackedObject>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const TrackedObject& x, const TrackedObject& y) {
                      return x.id == y.id && x.seen && y.seen;
                    });
}

bool nothingMoved(const std::vector<TrackedObject>& before, const std::vector<TrackedObject>& now,
                  const NominalFrame& nominal, const VisionSettings& settings) {
  if (!haveSameObjects(before, now)) return false;
  return std::equal(before.begin(), before.end(), now.begin(),
                    [&](const TrackedObject& a, const TrackedObject& b) {
                      return settings.stiffness_N_mm() * moved_mm(a, b, nominal) +
                                 reliefChange_N(a, b, nominal, settings) <=
                             settings.plan.error_budget_N;
                    });
}

}  // namespace hapticast::server
