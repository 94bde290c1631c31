// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/plot.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>

namespace hapticast::client {

namespace {
constexpr double kPlot_s = 8.0;  // chosen: a press and its release
}

void plot(const ForceHistory& history, double most, const char* unit, float height,
          std::span<const Curve> curves) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, height);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + size.x, corner.y + size.y);
  list.AddRectFilled(corner, end, IM_COL32(18, 20, 24, 255));
  const auto& points = history.points();
  const double now_s = points.empty() ? 0.0 : points.back().time_s;
  constexpr double kPoint_s = ForceHistory::kTicksPerPoint * 1e-3;
  const auto shown = std::min(points.size(), static_cast<std::size_t>(kPlot_s / kPoint_s));
  // One point per pixel is enough.
  const std::size_t stride = std::max<std::size_t>(1, shown / static_cast<std::size_t>(size.x + 1));
  for (const Curve& curve : curves) {
    for (std::size_t i = points.size() - shown; i < points.size(); i += stride) {
      const double age = (now_s - points[i].time_s) / kPlot_s;
      const double share = std::clamp(points[i].*curve.value / most, 0.0, 1.0);
      list.PathLineTo({end.x - size.x * static_cast<float>(age),
                       end.y - 1.0F - (size.y - 3.0F) * static_cast<float>(share)});
    }
    list.PathStroke(curve.color, 0, 1.5F);
  }
  const std::string scale = fmt::format("{:g} {}", most, unit);
  list.AddText({corner.x + 3.0F, corner.y + 1.0F}, IM_COL32(150, 150, 150, 255), scale.c_str());
  ImGui::Dummy(size);
}

double upperEnvelope(const ForceHistory& history, double ForcePoint::*value, double least) {
  const auto& points = history.points();
  double most = least;
  const double from_s = points.empty() ? 0.0 : points.back().time_s - kPlot_s;
  for (const ForcePoint& point : points) {
    while (point.time_s >= from_s && point.*value > most && most < 1e6) most *= 2.0;
  }
  return most;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
