// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/panel.hpp"

#include <SDL_keycode.h>
#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <utility>

#include "client/view/painter.hpp"

namespace hapticast::client {

namespace {

const std::array kForces{Curve{&ForcePoint::force_N, kForceColor},
                         Curve{&ForcePoint::static_force_N, kStaticForceColor},
                         Curve{&ForcePoint::dynamic_force_N, kDynamicForceColor}};
const std::array kDepth{Curve{&ForcePoint::penetration_mm, kContactColor}};

constexpr std::array<std::pair<const char*, const char*>, 12> kKeys{
    {{"pointer", "moves the tip over the picture"},
     {"wheel, drag", "moves the tip in and out"},
     {"space", "pauses and resumes time"},
     {"S, D", "static, dynamic force on and off"},
     {"M", "the thesis's method, and back"},
     {"R", "re-arms the force"},
     {"O", "outlines the objects"},
     {"V", "shades the relief, then shows it from the side"},
     {"L", "records a log: hapticast-1.csv ..."},
     {"P", "saves a picture: hapticast-1.png ..."},
     {"F1", "this help"},
     {"Ctrl-C", "ends, as closing the window does"}}};

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }

void heading(const char* name) {
  ImGui::Spacing();
  ImGui::TextColored(ImVec4(0.55F, 0.8F, 1.0F, 1.0F), "%s", name);
}

/// Returns the size in px of the screen of an image that is as wide as the panel.
cv::Size pixelsFor(const ImVec2& size) {
  const ImVec2& scale = ImGui::GetIO().DisplayFramebufferScale;
  return {std::max(1, static_cast<int>(size.x * scale.x)),
          std::max(1, static_cast<int>(size.y * scale.y))};
}

/// Shows a plot as wide as the panel. `height` is in px of the window.
void showPlot(GuiRenderer& renderer, GuiImage kind, const ForceHistory& history, const char* unit,
              std::span<const Curve> curves, float height) {
  const ImVec2 size(ImGui::GetContentRegionAvail().x, height);
  ImGui::Image(renderer.upload(kind, drawRecentPlot(history, 1.0, unit, curves, pixelsFor(size))),
               size);
}

void showForce(const TickReport& report, const ForceHistory& history, GuiRenderer& renderer,
               float plot_height) {
  heading("Force");
  const Vec3& force_N = report.force_N;
  text(fmt::format("{:.2f} N  ({:.2f}, {:.2f}, {:.2f})", force_N.norm(), force_N.x(), force_N.y(),
                   force_N.z()));
  const auto share = [](const cv::Scalar& color, const char* name, double value_N) {
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(toImGui(color)), "%s %.2f N", name, value_N);
  };
  share(kStaticForceColor, "static", report.static_force_N.norm());
  ImGui::SameLine();
  share(kDynamicForceColor, "dynamic", report.dynamic_force_N.norm());
  showPlot(renderer, GuiImage::kForcePlot, history, "N", kForces, plot_height);
  text(fmt::format("penetration {:.2f} mm, tip z {:.1f} mm", report.penetration_mm,
                   report.hip_mm.z()));
  showPlot(renderer, GuiImage::kPenetrationPlot, history, "mm", kDepth, 0.6F * plot_height);
}

void showNetwork(const TickWatch& ticks, const UiState& ui_state, double picture_off_ms) {
  heading("Stream");
  const ConnectionStats& stream = ui_state.stream;
  // During a pause the playout delay grows with the time and has no meaning.
  const double behind_ms = toSeconds(ticks.last().playout_delay) * 1e3;
  text((ui_state.user.paused ? "paused" : fmt::format("behind by {:.0f} ms", behind_ms)) +
       fmt::format(", clock ± {:.2f} ms", stream.clock_error_us * 1e-3));
  text(fmt::format("{} frames, {} lost, {} late", stream.frames_received, stream.frames_lost,
                   stream.frames_late));
  text(fmt::format("{} slices lost; eye - hand {:.0f} ms", stream.slices_lost, picture_off_ms));
  heading("Loop and safety");
  text(fmt::format("{} ticks, {} late; {:.0f} µs, {:.0f} at most", ticks.ticks(), ticks.lateTicks(),
                   ticks.mean_us(), ticks.longest_us()));
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
  heading("Feel");
  UserControls& user = ui_state.user;
  ImGui::Checkbox("pause (space)", &user.paused);
  ImGui::SameLine();
  bool thesis = user.method == Method::kThesis;
  if (ImGui::Checkbox("thesis (M)", &thesis))
    user.method = thesis ? Method::kThesis : Method::kHapticast;
  ImGui::Checkbox("static (S)", &user.static_on);
  ImGui::SameLine();
  ImGui::Checkbox("dynamic (D)", &user.dynamic_on);
  ImGui::PushItemWidth(0.4F * ImGui::GetContentRegionAvail().x);
  chooseSurface(user, thesis);
  slider("stiffness x", user.stiffness_factor, 0.1F, 3.0F);
  chooseFriction(user, state);
  slider("force x", user.force_factor, 0.0F, 1.0F);
  ImGui::PopItemWidth();
  if (ImGui::Button("re-arm (R)")) ++user.rearm;
  ImGui::SameLine();
  ImGui::Checkbox("record (L)", &ui_state.record);
  ImGui::SameLine();
  if (ImGui::Button("help (F1)")) state.help = !state.help;
}

}  // namespace

bool pressKey(int sdl_key, UiState& ui_state, PanelState& state) {
  UserControls& user = ui_state.user;
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
    case SDLK_l:
      flip(ui_state.record);
      return true;
    case SDLK_o:
      flip(state.outline);
      return true;
    case SDLK_v:
      state.relief = static_cast<ReliefLook>((static_cast<int>(state.relief) + 1) % 3);
      return true;
    case SDLK_F1:
      flip(state.help);
      return true;
    default:
      return false;
  }
}

void showPanel(const ImVec2& corner, const ImVec2& size, const TickWatch& ticks,
               const ForceHistory& history, GuiRenderer& renderer, UiState& ui_state,
               PanelState& state) {
  ImGui::SetNextWindowPos(corner);
  ImGui::SetNextWindowSize(size);
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration & ~ImGuiWindowFlags_NoScrollbar;
  ImGui::Begin("panel", nullptr,
               kFixed | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(6.0F, 2.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(4.0F, 2.0F));
  showForce(ticks.last(), history, renderer, (size.y < 600.0F ? 0.09F : 0.13F) * size.y);
  showControls(ui_state, state);
  showNetwork(ticks, ui_state, state.picture_off_ms);
  if (!ui_state.recording.empty()) ImGui::TextWrapped("%s", ui_state.recording.c_str());
  if (!state.note.empty()) ImGui::TextWrapped("%s", state.note.c_str());
  ImGui::PopStyleVar(2);
  ImGui::End();
}

void showHelp(const ImVec2& room, bool& open) {
  if (!open) return;
  ImGui::SetNextWindowPos({0.5F * room.x, 0.5F * room.y}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::Begin("Keys", &open,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoCollapse);
  for (const auto& [key, does] : kKeys) {
    ImGui::TextUnformatted(key);
    ImGui::SameLine(7.0F * ImGui::GetFontSize());
    ImGui::TextUnformatted(does);
  }
  ImGui::End();
}

namespace {

constexpr Duration kLate{1'500'000};
constexpr Duration kSecond = std::chrono::seconds(1);

std::string haltLine(const TickReport& report) {
  if (report.halt == Halt::kStopped) return "ending: the force fades to zero";
  if (deviceIsBack(report)) return "the device answers again: R re-arms the force";
  if (report.halt == Halt::kUnconfirmed) return "the client detected this device: R arms the force";
  if (report.halt == Halt::kDeviceLost) return "the device does not answer: no force";
  return "the client does not trust the stream: no force (R re-arms)";
}

}  // namespace

void TickWatch::add(const TickReport& report) {
  const Duration since = report.time - last_.time;
  if (ticks_++ > 0) {
    if (since > kLate) ++late_;
    second_longest_ = std::max(second_longest_, report.tick_duration);
    second_sum_ += report.tick_duration;
    ++second_ticks_;
  }
  if (report.time - second_begin_ >= kSecond) {
    longest_us_ = toSeconds(second_longest_) * 1e6;
    mean_us_ = toSeconds(second_sum_) * 1e6 /
               static_cast<double>(std::max<std::uint64_t>(second_ticks_, 1));
    second_longest_ = second_sum_ = Duration{0};
    second_ticks_ = 0;
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
    const char* const what = toText(static_cast<SafetyAction>(i));
    if (*what == '\0' || !ever_[i] || last_.time - acted_[i] > kSecond) continue;
    words.append(words.empty() ? "" : "; ").append(what);
  }
  return words.empty() ? "no action" : words;
}

std::string statusLine(const TickReport& report, const UiState& ui_state) {
  if (report.halt != Halt::kNone) return haltLine(report);
  if (!ui_state.stream.connected) return "no server yet: the client waits";
  if (!report.enabled) return "the device's button is not held: no force";
  const std::string paused = ui_state.user.paused ? "paused; " : "";
  if (report.lookup == Lookup::kStale) return paused + "no fresh frames: the force has faded";
  if (report.lookup == Lookup::kEmpty) return paused + "waiting for the first frames";
  if (report.contact) return fmt::format("{}in contact, {:.1f} N", paused, report.force_N.norm());
  return paused + (report.over_object ? "over the object" : "nothing touched");
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
