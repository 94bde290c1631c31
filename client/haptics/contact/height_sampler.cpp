// SPDX-License-Identifier: MIT
#include "client/haptics/contact/height_sampler.hpp"

namespace hapticast::client {

namespace {
// Bound on |gradient| of the edge distance. It is 1 for the exact distance; blur and splines exceed
// that slightly. Chosen: 1.2, above the largest value measured.
constexpr double kSteepestEdge = 1.2;
}  // namespace

void ReliefProbe::begin(const MovingRelief& relief, int samples) noexcept {
  relief_ = &relief;
  left_ = samples;
  used_ = 0;
}

ReliefProbe::Height ReliefProbe::height(const Vec2& q_mm) noexcept {
  if (height_known_ && q_mm == height_q_mm_) return {height_, relief_->now(height_)};
  --left_;
  ++used_;
  const MovingRelief::Heights frames = relief_->heights(q_mm);
  return {frames, relief_->now(frames)};
}

EdgeSample ReliefProbe::edge(const Vec2& q_mm) noexcept {
  if (!edge_known_ || q_mm != edge_q_mm_) {
    edge_ = relief_->edges(q_mm);
    edge_q_mm_ = q_mm;
    edge_known_ = true;
  }
  return relief_->now(edge_);
}

bool ReliefProbe::isMasked(const Vec2& q_mm) noexcept {
  if (edge_known_) {
    // No new sample if the stored sample is farther from the edge than the point is from the stored
    // sample.
    const double known_mm = relief_->now(edge_).distance_mm;
    const double reach_mm = known_mm / kSteepestEdge;
    if ((q_mm - edge_q_mm_).squaredNorm() < reach_mm * reach_mm) return known_mm > 0.0;
  }
  return edge(q_mm).distance_mm > 0.0;
}

void ReliefProbe::keep(const Vec2& q_mm, const Height& height) noexcept {
  height_ = height.frames;
  height_q_mm_ = q_mm;
  height_known_ = true;
}

}  // namespace hapticast::client
