// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/panel.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>

#include "client/view/painter.hpp"
#include "client/view/pointer_input.hpp"

namespace hapticast::client {

namespace {

const std::array kDepth{Curve{&ForcePoint::penetration_mm, kContactColor, "penetration"}};
constexpr float kPlot_px = 92.0F;  // least height of a plot with its labels

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }

void showHeading(const char* name) {
  ImGui::Spacing();
  ImGui::TextColored(ImVec4(0.55F, 0.8F, 1.0F, 1.0F), "%s", name);
}

/// Returns the size in px of the screen of an image that is as wide as the panel.
cv::Size computePixels(const ImVec2& size) {
  const ImVec2& scale = ImGui::GetIO().DisplayFramebufferScale;
  return {std::max(1, static_cast<int>(size.x * scale.x)),
          std::max(1, static_cast<int>(size.y * scale.y))};
}

/// Shows a plot as wide as the panel. `height` is in px of the window.
void showPlot(GuiRenderer& renderer, GuiImage kind, const ForceHistory& history, const char* unit,
              std::span<const Curve> curves, float height) {
  const ImVec2 size(ImGui::GetContentRegionAvail().x, height);
  ImGui::Image(
      renderer.upload(kind, drawRecentPlot(history, 1.0, unit, curves, computePixels(size))), size);
}

/// Explains the control or the text before it, while the pointer is over it.
void explain(const char* what) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", what);
}

void showForce(const TickReport& report, const ForceHistory& history, GuiRenderer& renderer,
               float plot_height) {
  showHeading("Force at the device");
  text(
      fmt::format("{:.2f} N, penetration {:.2f} mm", report.force_N.norm(), report.penetration_mm));
  showPlot(renderer, GuiImage::kForcePlot, history, "N", kForceCurves, plot_height);
  explain("device: force at the device\nstatic, dynamic: before the safety chain");
  showPlot(renderer, GuiImage::kPenetrationPlot, history, "mm", kDepth,
           std::max(0.8F * plot_height, 0.8F * kPlot_px));
}

void showStream(const TickStatus& ticks, const UiState& ui_state, double picture_off_ms) {
  const ConnectionStats& stream = ui_state.stream;
  // During a pause the playout delay grows with the time and has no meaning.
  const double behind_ms = toSeconds(ticks.last().playout_delay) * 1e3;
  text(ui_state.user.paused ? "paused" : fmt::format("behind by {:.0f} ms", behind_ms));
  explain("delay of play time behind the server");
  text(fmt::format("clock ± {:.2f} ms", stream.clock_error_us * 1e-3));
  explain("largest error of the server's clock");
  text(fmt::format("{} frames, {} lost, {} late", stream.frames_received, stream.frames_lost,
                   stream.frames_late));
  explain("late: arrived after play time needed them");
  text(fmt::format("{} slices lost", stream.slices_lost));
  explain("lost parts of reliefs; the part of the frame before replaces them");
  text(fmt::format("eye - hand {:.0f} ms", picture_off_ms));
  explain("play time of the shown picture minus that of the rendered frame");
}

void showLoop(const TickStatus& ticks) {
  const TickReport& report = ticks.last();
  text(fmt::format("HIP {:.1f}, {:.1f}, {:.1f} mm", report.hip_mm.x(), report.hip_mm.y(),
                   report.hip_mm.z()));
  explain("position of the tip: right, up, out of the picture");
  const Vec3& force_N = report.force_N;
  text(fmt::format("force {:.2f}, {:.2f}, {:.2f} N", force_N.x(), force_N.y(), force_N.z()));
  explain("force at the device: right, up, out of the picture");
  text(fmt::format("static {:.2f} N, dynamic {:.2f} N", report.static_force_N.norm(),
                   report.dynamic_force_N.norm()));
  explain("before the safety chain");
  text(fmt::format("{} ticks, {} late", ticks.ticks(), ticks.lateTicks()));
  explain("a late tick begins more than 1.5 ms after the tick before");
  text(fmt::format("tick {:.0f} µs, {:.0f} at most", ticks.mean_us(), ticks.longest_us()));
  explain("computing time of a tick in the last second");
  const PortWork& work = report.work;
  text(fmt::format("energy {:.1f} mJ", work.user_mJ()));
  explain("work of the force on the hand since the start");
  text(fmt::format("contact {:.1f}, surface {:.1f}, object {:.1f}", work.relative_mJ,
                   work.surface_mJ, work.object_mJ));
  explain("its parts: contact itself, moving surface, dynamic force");
  ImGui::TextWrapped("chain: %s", ticks.chain().c_str());
  explain("safety actions of the last second");
}

void slider(const char* name, double& value, float low, float high) {
  auto shown = static_cast<float>(value);
  if (ImGui::SliderFloat(name, &shown, low, high, "%.2f", ImGuiSliderFlags_AlwaysClamp))
    value = double{shown};
}

/// Control for the surface; the thesis's method has a surface of its own.
void chooseSurface(UserControls& user, bool thesis) {
  constexpr const char* kNames = "perturbed\0normal\0proxy\0";  // in the order of SurfaceKind
  const SurfaceKind rendered =
      thesis ? SurfaceKind::kPerturbed : user.surface.value_or(SurfaceKind::kProxy);
  auto shown = static_cast<int>(rendered);
  ImGui::BeginDisabled(thesis);
  if (ImGui::Combo("surface", &shown, kNames)) user.surface = static_cast<SurfaceKind>(shown);
  ImGui::EndDisabled();
}

void chooseFriction(UserControls& user, PanelState& state) {
  bool authors = !user.friction;
  ImGui::BeginDisabled(authors);
  slider("friction", state.friction, 0.0F, 1.0F);
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::Checkbox("author's", &authors);
  user.friction.reset();
  if (!authors) user.friction = state.friction;
}

void showControls(UiState& ui_state, PanelState& state) {
  showHeading("Feel");
  UserControls& user = ui_state.user;
  ImGui::Checkbox("pause (space)", &user.paused);
  explain("stops play time, so that you can explore the frame");
  ImGui::Checkbox("static (S)", &user.static_on);
  explain("force of the surface");
  ImGui::SameLine();
  ImGui::Checkbox("dynamic (D)", &user.dynamic_on);
  explain("force of the object's acceleration");
  ImGui::PushItemWidth(0.45F * ImGui::GetContentRegionAvail().x);
  slider("force x", user.force_factor, 0.0F, 1.0F);
  explain("share of the force");
  ImGui::PopItemWidth();
  if (ImGui::Button("re-arm (R)")) ++user.rearm;
  explain("brings the force back after a halt");
  ImGui::SameLine();
  if (ImGui::Button("lift (Home)")) PointerInput::lift(ui_state.pointer);
  explain("brings the tip back to the start above the picture");
  ImGui::Checkbox("record (L)", &ui_state.record);
  ImGui::SameLine();
  if (ImGui::Button("relief (V)")) switchRelief(state);
  explain("shades the relief; again: shows it from the side; again: off");
}

void showSurfaceControls(UserControls& user, PanelState& state) {
  bool thesis = user.method == Method::kThesis;
  if (ImGui::Checkbox("thesis (M)", &thesis))
    user.method = thesis ? Method::kThesis : Method::kHapticast;
  explain("renders by the method of the thesis");
  ImGui::PushItemWidth(0.4F * ImGui::GetContentRegionAvail().x);
  chooseSurface(user, thesis);
  explain("model of the surface");
  slider("stiffness x", user.stiffness_factor, 0.1F, 3.0F);
  explain("factor of the author's stiffness");
  chooseFriction(user, state);
  explain("off: your value replaces the author's friction");
  ImGui::PopItemWidth();
}

/// Sections that are folded at first.
void showExpertSections(const TickStatus& ticks, UiState& ui_state, PanelState& state) {
  if (ImGui::CollapsingHeader("Surface")) showSurfaceControls(ui_state.user, state);
  if (ImGui::CollapsingHeader("Stream")) showStream(ticks, ui_state, state.picture_off_ms);
  if (ImGui::CollapsingHeader("Loop and safety")) showLoop(ticks);
}

}  // namespace

void showPanel(const WindowLayout& layout, const TickStatus& ticks, const ForceHistory& history,
               GuiRenderer& renderer, UiState& ui_state, PanelState& state) {
  const ImVec2& window = ImGui::GetIO().DisplaySize;
  const auto width = static_cast<float>(layout.panel_px);
  ImGui::SetNextWindowPos({window.x - width, 0.0F});
  ImGui::SetNextWindowSize({width, window.y});
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration & ~ImGuiWindowFlags_NoScrollbar;
  ImGui::Begin("panel", nullptr,
               kFixed | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(6.0F, 3.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(4.0F, 2.0F));
  if (ImGui::Button("fold (F2)")) togglePanel(state);
  ImGui::SameLine();
  if (ImGui::Button("help (F1)")) state.help = !state.help;
  showForce(ticks.last(), history, renderer, std::max(0.14F * window.y, kPlot_px));
  showControls(ui_state, state);
  if (!ui_state.recording.empty()) ImGui::TextWrapped("%s", ui_state.recording.c_str());
  if (!state.note.empty()) ImGui::TextWrapped("%s", state.note.c_str());
  ImGui::Spacing();
  ImGui::PushTextWrapPos(0.0F);
  if (ImGui::CollapsingHeader("Legend", ImGuiTreeNodeFlags_DefaultOpen)) showLegend();
  ImGui::PopTextWrapPos();
  showExpertSections(ticks, ui_state, state);
  ImGui::PopStyleVar(2);
  ImGui::End();
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
