// SPDX-License-Identifier: MIT
#include "client/view/window_panel.hpp"

#include <SDL_keycode.h>
#include <fmt/core.h>

#include <algorithm>

#include "client/view/window_scene.hpp"

namespace hapticast::client {

namespace {

constexpr double kPlot_s = 8.0;  // chosen: a press and its release
constexpr Duration kLate{1'500'000};
constexpr Duration kSecond = std::chrono::seconds(1);

std::string haltLine(const TickReport& report) {
  if (report.halt == Halt::kStopped) return "ending: the force goes to zero";
  if (deviceIsBack(report)) return "the device is back: R re-arms the force";
  if (report.halt == Halt::kDeviceLost) return "the device does not answer: no force";
  return "the stream is not trusted any more: no force (R re-arms)";
}

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }

void heading(const char* name) {
  ImGui::Spacing();
  ImGui::TextColored(ImVec4(0.55F, 0.8F, 1.0F, 1.0F), "%s", name);
}

/// One line of a plot over the last seconds.
struct Curve {
  double ForcePoint::*value;
  ImU32 color;
};

template <std::size_t kCurves>
void plot(const ForceHistory& history, double most, const char* unit, float height,
          const std::array<Curve, kCurves>& curves) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, height);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + size.x, corner.y + size.y);
  list.AddRectFilled(corner, end, IM_COL32(18, 20, 24, 255));
  const auto& points = history.points();
  const double now_s = points.empty() ? 0.0 : points.back().time_s;
  constexpr double kPoint_s = ForceHistory::kTicksPerPoint * 1e-3;
  const auto shown = std::min(points.size(), static_cast<std::size_t>(kPlot_s / kPoint_s));
  // A point a pixel is all that can be seen.
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

/// A round number that what was there in the plotted time stays below.
double ceilingOf(const ForceHistory& history, double ForcePoint::*value, double least) {
  const auto& points = history.points();
  double most = least;
  const double from_s = points.empty() ? 0.0 : points.back().time_s - kPlot_s;
  for (const ForcePoint& point : points) {
    while (point.time_s >= from_s && point.*value > most && most < 1e6) most *= 2.0;
  }
  return most;
}

void showForce(const TickReport& report, const ForceHistory& history, float plot_height) {
  heading("Force");
  const Vec3& force_N = report.force_N;
  text(fmt::format("{:.2f} N  ({:.2f}, {:.2f}, {:.2f})", force_N.norm(), force_N.x(), force_N.y(),
                   force_N.z()));
  const auto share = [](ImU32 color, const char* name, double value_N) {
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(color), "%s %.2f N", name, value_N);
  };
  share(kStaticColor, "static", report.static_force_N.norm());
  ImGui::SameLine();
  share(kDynamicColor, "dynamic", report.dynamic_force_N.norm());
  plot<3>(history, ceilingOf(history, &ForcePoint::force_N, 1.0), "N", plot_height,
          {{{&ForcePoint::force_N, kTotalColor},
            {&ForcePoint::static_force_N, kStaticColor},
            {&ForcePoint::dynamic_force_N, kDynamicColor}}});
  text(fmt::format("penetration {:.2f} mm, tip z {:.1f} mm", report.penetration_mm,
                   report.hip_mm.z()));
  plot<1>(history, ceilingOf(history, &ForcePoint::penetration_mm, 1.0), "mm", 0.6F * plot_height,
          {{{&ForcePoint::penetration_mm, IM_COL32(90, 255, 120, 255)}}});
}

void showNetwork(const TickWatch& ticks, const StreamStatus& stream, double picture_off_ms) {
  heading("Stream");
  text(fmt::format("behind by {:.0f} ms, clock ± {:.2f} ms",
                   toSeconds(ticks.last().playout_delay) * 1e3, stream.clock_error_us * 1e-3));
  text(fmt::format("{} frames, {} lost, {} late", stream.frames_received, stream.frames_lost,
                   stream.frames_late));
  text(fmt::format("{} parts lost; eye - hand {:.0f} ms", stream.slices_lost, picture_off_ms));
  heading("Loop and safety");
  text(fmt::format("{} ticks, {} late, {:.1f} ms at most", ticks.ticks(), ticks.lateTicks(),
                   ticks.longest_ms()));
  const PortWork& work = ticks.last().work;
  text(fmt::format("energy {:.1f} mJ: contact {:.1f},", work.user_mJ(), work.relative_mJ));
  text(fmt::format("  surface {:.1f}, object {:.1f}", work.surface_mJ, work.object_mJ));
  ImGui::TextWrapped("chain: %s", ticks.chain().c_str());
}

void slider(const char* name, double& value, float low, float high) {
  auto shown = static_cast<float>(value);
  if (ImGui::SliderFloat(name, &shown, low, high, "%.2f", ImGuiSliderFlags_AlwaysClamp))
    value = double{shown};
}

void showControls(Desk& desk, PanelState& state) {
  heading("Feel");
  UserControls& user = desk.user;
  ImGui::Checkbox("pause (space)", &user.paused);
  ImGui::Checkbox("static (S)", &user.static_on);
  ImGui::SameLine();
  ImGui::Checkbox("dynamic (D)", &user.dynamic_on);
  bool thesis = user.method == Method::kThesis;
  if (ImGui::Checkbox("thesis's method (M)", &thesis))
    user.method = thesis ? Method::kThesis : Method::kHapticast;
  ImGui::PushItemWidth(0.45F * ImGui::GetContentRegionAvail().x);
  int surface = static_cast<int>(user.surface.value_or(SurfaceKind::kProxy));
  if (ImGui::Combo("surface", &surface, "perturbed\0normal\0proxy\0"))
    user.surface = static_cast<SurfaceKind>(surface);
  slider("stiffness x", user.stiffness_factor, 0.1F, 3.0F);
  double friction = user.friction.value_or(0.0);
  slider("friction", friction, 0.0F, 1.0F);
  if (friction != user.friction.value_or(0.0)) user.friction = friction;
  slider("force x", user.force_factor, 0.0F, 1.0F);
  ImGui::PopItemWidth();
  if (ImGui::Button("re-arm (R)")) ++user.rearm;
  ImGui::SameLine();
  if (ImGui::Button("help (F1)")) state.help = !state.help;
}

}  // namespace

void TickWatch::add(const TickReport& report) {
  const Duration since = report.time - last_.time;
  if (ticks_++ > 0) {
    if (since > kLate) ++late_;
    second_longest_ms_ = std::max(second_longest_ms_, toSeconds(since) * 1e3);
  }
  if (report.time - second_begin_ >= kSecond) {
    longest_ms_ = second_longest_ms_;
    second_longest_ms_ = 0.0;
    second_begin_ = report.time;
  }
  for (std::size_t i = 0; i < acted_.size(); ++i) {
    if ((report.interferences >> i & 1U) == 0) continue;
    acted_[i] = report.time;
    ever_[i] = true;
  }
  last_ = report;
}

std::string TickWatch::chain() const {
  std::string words;
  for (std::size_t i = 0; i < acted_.size(); ++i) {
    if (!ever_[i] || last_.time - acted_[i] > kSecond) continue;
    words.append(words.empty() ? "" : ", ").append(kInterferenceNames[i]);
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return words.empty() ? "nothing to do" : words;
}

std::string statusLine(const TickReport& report, const Desk& desk) {
  if (report.halt != Halt::kNone) return haltLine(report);
  if (!desk.stream.connected) return "no server yet: waiting for one";
  if (!report.enabled) return "the device's button is not held: no force";
  const std::string paused = desk.user.paused ? "paused; " : "";
  if (report.lookup == Lookup::kFaded) return paused + "no fresh frames: the force has faded";
  if (report.lookup == Lookup::kNone) return paused + "waiting for the first frames";
  if (report.contact) return fmt::format("{}in contact, {:.1f} N", paused, report.force_N.norm());
  return paused + (report.over_object ? "over the object" : "nothing touched");
}

bool pressKey(int sdl_key, Desk& desk, PanelState& state) {
  UserControls& user = desk.user;
  const auto flip = [](bool& value) { value = !value; };
  switch (sdl_key) {
    case SDLK_SPACE:
      flip(user.paused);
      return true;
    case SDLK_s:
      flip(user.static_on);
      return true;
    case SDLK_d:
      flip(user.dynamic_on);
      return true;
    case SDLK_m:
      user.method = user.method == Method::kThesis ? Method::kHapticast : Method::kThesis;
      return true;
    case SDLK_r:
      ++user.rearm;
      return true;
    case SDLK_F1:
      flip(state.help);
      return true;
    default:
      return false;
  }
}

void showPanel(const ImVec2& corner, const ImVec2& size, const TickWatch& ticks,
               const ForceHistory& history, Desk& desk, PanelState& state) {
  ImGui::SetNextWindowPos(corner);
  ImGui::SetNextWindowSize(size);
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration & ~ImGuiWindowFlags_NoScrollbar;
  ImGui::Begin("panel", nullptr,
               kFixed | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  showForce(ticks.last(), history, 0.13F * size.y);
  showControls(desk, state);
  showNetwork(ticks, desk.stream, state.picture_off_ms);
  if (!state.note.empty()) ImGui::TextWrapped("%s", state.note.c_str());
  ImGui::End();
}

void showHelp(const ImVec2& room, bool& open) {
  if (!open) return;
  ImGui::SetNextWindowPos({0.5F * room.x, 0.5F * room.y}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::Begin("Keys", &open,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoCollapse);
  text(
      "pointer        moves the tip over the picture\n"
      "wheel, or drag   presses it in, lets it out\n"
      "space      pauses time and lets it go on\n"
      "S, D        static, dynamic force on and off\n"
      "M           the thesis's method, and back\n"
      "R            re-arms the force\n"
      "P            saves a picture of the window\n"
      "F1          this help\n"
      "close the window, or Ctrl-C, to end");
  ImGui::End();
}

}  // namespace hapticast::client
