// SPDX-License-Identifier: MIT
#include "client/view/window/relief_box.hpp"

namespace hapticast::client {

namespace {

constexpr double kBoxShare = 0.4;  // chosen, share of the picture: its middle stays free

}  // namespace

cv::Rect2d ReliefBox::rect(const ScenePlace& place) const {
  const Vec2 size = kBoxShare * place.size();
  const Vec2 corner = place.corner() + share_.cwiseProduct(place.size() - size);
  return {corner.x(), corner.y(), size.x(), size.y()};
}

BoxPart ReliefBox::part(const ScenePlace& place, const Vec2& point) const {
  const cv::Rect2d box = rect(place);
  if (!box.contains({point.x(), point.y()})) return BoxPart::kNone;
  if (point.y() >= box.y + kTitle_px) return BoxPart::kBody;
  return point.x() >= box.br().x - kTitle_px ? BoxPart::kClose : BoxPart::kTitle;
}

void ReliefBox::move(const ScenePlace& place, const Vec2& by_px) {
  const Vec2 free_px = ((1.0 - kBoxShare) * place.size()).cwiseMax(1.0);
  share_ = (share_ + by_px.cwiseQuotient(free_px)).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace hapticast::client
