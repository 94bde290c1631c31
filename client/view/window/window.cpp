// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/window.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "client/view/picture.hpp"
#include "client/view/window/display.hpp"
#include "client/view/window/imgui_sdl.hpp"
#include "client/view/window/study_window.hpp"
#include "common/unique_filename.hpp"

namespace hapticast::client {

namespace {

constexpr std::uint32_t kFullscreen = SDL_WINDOW_FULLSCREEN_DESKTOP;

[[noreturn]] void throwFailure(const char* what) {
  throw std::runtime_error(fmt::format("{} ({})", what, SDL_GetError()));
}

/// Returns true if SDL fell back to drawing into memory without a display, and SDL_VIDEODRIVER does
/// not request that.
bool drawsForNobody() {
  const std::string driver = SDL_GetCurrentVideoDriver();
  return (driver == "offscreen" || driver == "dummy") && SDL_getenv("SDL_VIDEODRIVER") == nullptr;
}

/// Draws `text` in the middle of the picture, on a dark ground. `down` is the share of the height
/// that lies above it.
void drawNote(ImDrawList& list, const ScenePlace& place, const std::string& text, ImU32 colour,
              double down) {
  if (text.empty()) return;
  const float margin = 0.5F * ImGui::GetFontSize();
  const auto most = static_cast<float>(0.9 * place.size().x());
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, most);
  const auto middle = static_cast<float>(place.corner().x() + 0.5 * place.size().x());
  const ImVec2 corner(
      middle - 0.5F * size.x,
      static_cast<float>(place.corner().y() + down * place.size().y()) + 2.0F * margin);
  list.AddRectFilled({corner.x - margin, corner.y - margin},
                     {corner.x + size.x + margin, corner.y + size.y + margin},
                     IM_COL32(18, 20, 24, 215), 4.0F);
  list.AddText(nullptr, 0.0F, corner, colour, text.c_str(), nullptr, most);
}

}  // namespace

struct ViewerWindow::Gui {
  Gui(int width_px, int height_px, bool fullscreen) {
    // Ctrl-C ends the client as it does without a window.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) throwFailure("no display");
    if (drawsForNobody()) {
      SDL_SetError("SDL cannot open the named display");
      end("no display");
    }
    const std::uint32_t flags =
        SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI | (fullscreen ? kFullscreen : 0U);
    window = SDL_CreateWindow("hapticast", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width_px,
                              height_px, flags);
    if (window == nullptr) end("no window");
    SDL_SetWindowMinimumSize(window, 640, 480);
    renderer = SDL_CreateRenderer(window, -1, 0);
    if (renderer == nullptr) renderer = SDL_CreateRenderer(window, -1, SDL_RENDERER_SOFTWARE);
    if (renderer == nullptr) end("SDL cannot draw");
    surviveDisplay(*window);  // here, because SDL recreates the window for a renderer
    context = ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsDark();
    connectGui(*window, *renderer);
    gui_renderer = std::make_unique<GuiRenderer>(*renderer);
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  ~Gui() {
    if (displayIsLost()) {
      (void)gui_renderer.release();  // its textures belong to the lost display
      return;
    }
    gui_renderer.reset();
    ImGui_ImplSDL2_Shutdown();
    ImGui::DestroyContext(context);
    close();
  }
  [[noreturn]] void end(const char* what) const {
    const std::string why = SDL_GetError();
    close();
    SDL_SetError("%s", why.c_str());
    throwFailure(what);
  }
  void close() const {
    if (renderer != nullptr) SDL_DestroyRenderer(renderer);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }

  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  ImGuiContext* context = nullptr;
  std::unique_ptr<GuiRenderer> gui_renderer;
};

ViewerWindow::ViewerWindow(int width_px, int height_px, bool fullscreen)
    : gui_(std::make_unique<Gui>(width_px, height_px, fullscreen)),
      place_(workspace_, {0, 0}, {640, 480}) {
  UiState before_the_first_update;
  draw(before_the_first_update);  // the start of a device may last a second
}

ViewerWindow::~ViewerWindow() = default;

void ViewerWindow::onPicture(VideoFrame picture, const Workspace& workspace) {
  pictures_.add(std::move(picture), workspace);
}

void ViewerWindow::onReport(const TickReport& report) {
  ticks_.add(report);
  history_.add(report);
}

void ViewerWindow::finish() {
  if (displayIsLost())
    throw std::runtime_error("the window closed: the display ended or removed it");
}

void ViewerWindow::draw(UiState& ui_state) {
  int width = 0;
  int height = 0;
  SDL_GetWindowSize(gui_->window, &width, &height);
  const auto panel_wanted = ui_state.study ? std::optional(false) : state_.panel;
  const WindowLayout layout = arrangeWindow(Vec2(width, height), panel_wanted);
  // A prompt of a study is read from a distance, beside a device.
  gui_->gui_renderer->setTextHeight(ui_state.study ? layout.text_px * 4 / 3 : layout.text_px);
  selectPicture(ui_state.picture_ahead);
  ImGui_ImplSDL2_NewFrame();
  ImGui::NewFrame();
  showScene(layout, ui_state);
  if (ui_state.study) {
    showStudyPrompt(layout, ui_state);
    return present();
  }
  showTexts(layout, ui_state);
  state_.folded = layout.isFolded();
  if (state_.folded) {
    showButtons(layout, state_);
  } else {
    showPanel(layout, ticks_, history_, *gui_->gui_renderer, ui_state, state_);
  }
  state_.time_bar.play_time = ticks_.last().play_time;
  showTimeBar(layout, ui_state, state_.time_bar);
  showHelp(layout, state_.help);
  present();
}

void ViewerWindow::present() {
  ImGui::Render();
  SDL_SetRenderDrawColor(gui_->renderer, 24, 26, 28, 255);
  SDL_RenderClear(gui_->renderer);
  gui_->gui_renderer->paint(*ImGui::GetDrawData());
  if (save_) savePicture();
  SDL_RenderPresent(gui_->renderer);
}

/// Decodes the picture of the rendered frame, if it is a new one.
void ViewerWindow::selectPicture(Duration ahead) {
  const MediaTime play_time = ticks_.last().play_time + ahead;
  const auto off = [play_time](const StreamPicture& picture) {
    return std::abs((picture.video.media_time - play_time).count());
  };
  auto nearest = pictures_.findNearest(play_time);
  // During a pause the buffer continues and drops the picture of the shown frame.
  if (nearest && (!shown_ || off(*nearest) < off(*shown_))) {
    shown_ = std::move(nearest);
    workspace_ = shown_->workspace;
    cv::Mat picture = decodeJpeg(shown_->video.jpeg, {workspace_.width_px, workspace_.height_px});
    if (!picture.empty()) picture_ = std::move(picture);
  }
  if (!shown_) return;
  const Duration apart = shown_->video.media_time - play_time;
  state_.picture_off_ms = toSeconds(apart) * 1e3;
  if (ticks_.last().lookup == Lookup::kInterpolated && play_time != last_play_time_)
    eye_hand_ns_.add(std::abs(apart.count()));
  last_play_time_ = play_time;
}

void ViewerWindow::showScene(const WindowLayout& layout, const UiState& ui_state) {
  place_ = ScenePlace(workspace_, layout.corner, layout.room);
  placed_ = shown_ != nullptr;
  relief_.update(ticks_.last().play_time, workspace_);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto point = [](const Vec2& at) {
    return ImVec2(static_cast<float>(at.x()), static_cast<float>(at.y()));
  };
  const PointerTarget pointer = ui_state.pointer_is_device ? ui_state.pointer : PointerTarget{};
  list.AddImage(
      gui_->gui_renderer->upload(GuiImage::kScene, paintScene(pointer, ui_state.study.has_value())),
      point(place_.corner()), point(place_.end()));
  if (state_.relief == ReliefLook::kInSpace) relief_.drawInSpace(list, place_, ticks_.last());
}

/// Draws the status line above the picture, and the hint in it.
void ViewerWindow::showTexts(const WindowLayout& layout, const UiState& ui_state) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float margin = 0.4F * ImGui::GetFontSize();
  const std::string status = statusLine(ticks_.last(), ui_state);
  const auto wrap = static_cast<float>(layout.room.x() - buttonsWidth_px(layout)) - 2.0F * margin;
  list.AddText(nullptr, 0.0F, {margin, margin}, IM_COL32(235, 235, 235, 255), status.c_str(),
               nullptr, wrap);
  if (!state_.help)
    drawNote(list, place_, hintLine(ticks_, ui_state), IM_COL32(255, 240, 180, 255), 0.0);
  drawNote(list, place_, stateLines(ticks_.last(), ui_state.stream), IM_COL32(255, 110, 100, 255),
           0.84);
}

/// Returns the picture with the HIP and the forces, in px of the screen. In a study the picture
/// does not show what the hand should sense.
cv::Mat ViewerWindow::paintScene(const PointerTarget& pointer, bool is_study) {
  const ImVec2& scale = ImGui::GetIO().DisplayFramebufferScale;
  const Vec2 size = place_.size().cwiseProduct(Vec2(scale.x, scale.y));
  cv::Mat image = fitPicture(picture_, {std::max(1, static_cast<int>(std::lround(size.x()))),
                                        std::max(1, static_cast<int>(std::lround(size.y())))});
  const ScenePlace place(workspace_, Vec2::Zero(), {image.cols, image.rows});
  if (state_.relief == ReliefLook::kShaded) relief_.drawShaded(image, place);
  if (state_.outline) relief_.drawOutline(image, place);
  TickReport shown = ticks_.last();
  if (is_study) {
    shown.force_N = shown.static_force_N = shown.dynamic_force_N = Vec3::Zero();
    shown.contact = false;
  }
  drawTouch(image, place, shown, pointer);
  return image;
}

cv::Mat ViewerWindow::pixels() const {
  cv::Size size;
  SDL_GetRendererOutputSize(gui_->renderer, &size.width, &size.height);
  cv::Mat picture(size, CV_8UC3);
  const bool read = SDL_RenderReadPixels(gui_->renderer, nullptr, SDL_PIXELFORMAT_BGR24,
                                         picture.data, static_cast<int>(picture.step)) == 0;
  return read ? picture : cv::Mat();
}

void ViewerWindow::toggleFullscreen() {
  const bool is = (SDL_GetWindowFlags(gui_->window) & kFullscreen) == kFullscreen;
  SDL_SetWindowFullscreen(gui_->window, is ? 0U : kFullscreen);
}

void ViewerWindow::savePicture() {
  save_ = false;
  const std::string file = nextFreeFilename(".png");
  const auto error = writePicture(file, pixels());
  state_.note = error ? file + ": " + error->message : "saved " + file;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
