// SPDX-License-Identifier: MIT
#include "client/view/window.hpp"

#include <backends/imgui_impl_sdl.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "client/view/picture.hpp"
#include "client/view/window_display.hpp"

namespace hapticast::client {

namespace {

constexpr std::uint64_t kFrame_ms = 16;  // chosen: as screens do
constexpr double kWheel_mm = 1.0;        // chosen: a notch of the wheel
constexpr double kDrag_mm_per_px = 0.1;  // chosen: half a hand's way is a press
// As far as the tip goes before and behind the picture.
constexpr double kNearest_mm = 35.0;
constexpr double kFarthest_mm = -5.0;

[[noreturn]] void failed(const char* what) {
  throw std::runtime_error(fmt::format("--view on: {} ({})", what, SDL_GetError()));
}

/// The share of the window that is the panel's.
float panelWidth(const ImVec2& window) { return std::clamp(0.3F * window.x, 250.0F, 460.0F); }

int textHeight(const ImVec2& window) {
  return window.y < 600.0F ? 13 : window.y < 1000.0F ? 15 : 19;
}

}  // namespace

struct ViewerWindow::Gui {
  Gui(int width_px, int height_px) {
    // Ctrl-C ends the client as it does without a window.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) failed("no display");
    constexpr std::uint32_t kFlags = SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI;
    window = SDL_CreateWindow("hapticast", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width_px,
                              height_px, kFlags);
    if (window == nullptr) end("no window");
    SDL_SetWindowMinimumSize(window, 640, 480);
    renderer = SDL_CreateRenderer(window, -1, 0);
    if (renderer == nullptr) renderer = SDL_CreateRenderer(window, -1, SDL_RENDERER_SOFTWARE);
    if (renderer == nullptr) end("nothing can be drawn");
    surviveDisplay(*window);  // now: for a renderer SDL makes a window anew
    context = ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsDark();
    ImGui_ImplSDL2_InitForSDLRenderer(window);
    painter = std::make_unique<WindowPainter>(*renderer);
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  ~Gui() {
    if (displayIsLost()) {
      (void)painter.release();  // its textures are the display's
      return;
    }
    painter.reset();
    ImGui_ImplSDL2_Shutdown();
    ImGui::DestroyContext(context);
    close();
  }
  [[noreturn]] void end(const char* what) const {
    const std::string why = SDL_GetError();
    close();
    SDL_SetError("%s", why.c_str());
    failed(what);
  }
  void close() const {
    if (renderer != nullptr) SDL_DestroyRenderer(renderer);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }

  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  ImGuiContext* context = nullptr;
  std::unique_ptr<WindowPainter> painter;
};

ViewerWindow::ViewerWindow(int width_px, int height_px)
    : gui_(std::make_unique<Gui>(width_px, height_px)), place_(workspace_, {0, 0}, {640, 480}) {}

ViewerWindow::~ViewerWindow() {
  if (displayIsLost()) (void)texture_.release();
}

void ViewerWindow::takePicture(VideoFrame picture, const Workspace& workspace) {
  pictures_.add(std::move(picture), workspace);
}

void ViewerWindow::takeReport(const TickReport& report) {
  ticks_.add(report);
  history_.add(report);
}

bool ViewerWindow::turn(Desk& desk) {
  if (displayIsLost()) return false;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) hear(event, desk);
  const std::uint64_t now_ms = SDL_GetTicks64();
  if (now_ms - drawn_ms_ >= kFrame_ms && !displayIsLost()) {
    drawn_ms_ = now_ms;
    draw(desk);
  }
  return !closed_ && !displayIsLost();
}

void ViewerWindow::finish() {
  if (displayIsLost()) throw std::runtime_error("the window is gone: its display took it away");
}

void ViewerWindow::hear(const SDL_Event& event, Desk& desk) {
  hearDisplay(event);
  ImGui_ImplSDL2_ProcessEvent(&event);
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 cursor(static_cast<float>(event.button.x), static_cast<float>(event.button.y));
  switch (event.type) {
    case SDL_QUIT:
      closed_ = true;
      break;
    case SDL_KEYDOWN:
      if (io.WantTextInput || event.key.repeat != 0) break;
      if (event.key.keysym.sym == SDLK_p) save_ = true;
      (void)pressKey(event.key.keysym.sym, desk, state_);
      break;
    case SDL_MOUSEMOTION:
      point(event.motion, desk);
      break;
    case SDL_MOUSEWHEEL:
      if (!io.WantCaptureMouse) press(-kWheel_mm * double{event.wheel.preciseY}, desk);
      break;
    case SDL_MOUSEBUTTONDOWN:
      if (event.button.button == SDL_BUTTON_LEFT && place_.contains(cursor) && !io.WantCaptureMouse)
        drag(true);
      break;
    case SDL_MOUSEBUTTONUP:
      if (event.button.button == SDL_BUTTON_LEFT) drag(false);
      break;
    default:
      break;
  }
}

void ViewerWindow::point(const SDL_MouseMotionEvent& motion, Desk& desk) {
  if (dragging_) {
    press(kDrag_mm_per_px * motion.yrel, desk);
    return;
  }
  const ImVec2 at(static_cast<float>(motion.x), static_cast<float>(motion.y));
  if (!place_.contains(at) || ImGui::GetIO().WantCaptureMouse) return;
  if (!desk.pointer.known) {  // in depth it begins where the tip is
    desk.pointer = {.known = true, .position_mm = ticks_.last().hip_mm};
    press(0.0, desk);
  }
  desk.pointer.position_mm.head<2>() = place_.toNominal(at);
}

/// Into the picture.
void ViewerWindow::press(double by_mm, Desk& desk) const {
  double& z_mm = desk.pointer.position_mm.z();
  z_mm = std::clamp(z_mm - by_mm, kFarthest_mm, kNearest_mm);
}

/// While a drag lasts the pointer stays where it was and has no edge to stop at.
void ViewerWindow::drag(bool begins) {
  dragging_ = begins;
  SDL_SetRelativeMouseMode(begins ? SDL_TRUE : SDL_FALSE);
}

void ViewerWindow::draw(Desk& desk) {
  const ImGuiIO& io = ImGui::GetIO();
  int width = 0;
  int height = 0;
  SDL_GetWindowSize(gui_->window, &width, &height);
  gui_->painter->setTextHeight(
      textHeight(ImVec2(static_cast<float>(width), static_cast<float>(height))));
  showPicture();
  ImGui_ImplSDL2_NewFrame();
  ImGui::NewFrame();
  const float panel = panelWidth(io.DisplaySize);
  showScene(desk);
  showPanel({io.DisplaySize.x - panel, 0.0F}, {panel, io.DisplaySize.y}, ticks_, history_, desk,
            state_);
  showHelp({io.DisplaySize.x - panel, io.DisplaySize.y}, state_.help);
  ImGui::Render();
  SDL_SetRenderDrawColor(gui_->renderer, 24, 26, 28, 255);
  SDL_RenderClear(gui_->renderer);
  gui_->painter->paint(*ImGui::GetDrawData());
  if (save_) savePicture();
  SDL_RenderPresent(gui_->renderer);
}

/// Takes the picture of the frame that is felt to the screen, if it is another one.
void ViewerWindow::showPicture() {
  const MediaTime play_time = ticks_.last().play_time;
  const auto off = [play_time](const StreamPicture& picture) {
    return std::abs((picture.video.media_time - play_time).count());
  };
  auto nearest = pictures_.nearest(play_time);
  // While time is paused the buffer goes on, and forgets the picture of the frame that stands.
  const bool nearer = nearest && (!shown_ || off(*nearest) < off(*shown_));
  if (shown_) state_.picture_off_ms = toSeconds(shown_->video.media_time - play_time) * 1e3;
  if (!nearer) return;
  shown_ = std::move(nearest);
  workspace_ = shown_->workspace;
  const cv::Size size(workspace_.width_px, workspace_.height_px);
  const cv::Mat picture = decodeJpeg(shown_->video.jpeg, size);
  if (picture.empty()) return;
  if (!texture_ || texture_size_ != size) {
    texture_.reset(SDL_CreateTexture(gui_->renderer, SDL_PIXELFORMAT_BGR24,
                                     SDL_TEXTUREACCESS_STREAMING, size.width, size.height));
    texture_size_ = size;
    SDL_SetTextureScaleMode(texture_.get(), SDL_ScaleModeLinear);
  }
  SDL_UpdateTexture(texture_.get(), nullptr, picture.data, static_cast<int>(picture.step));
}

void ViewerWindow::showScene(Desk& desk) {
  const ImVec2& window = ImGui::GetIO().DisplaySize;
  const float head = 1.8F * ImGui::GetFontSize();
  place_ = ScenePlace(workspace_, {0.0F, head},
                      {window.x - panelWidth(window), std::max(window.y - head, 1.0F)});
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  if (texture_) {
    list.AddImage(texture_.get(), place_.corner(), place_.end());
  } else {
    list.AddRectFilled(place_.corner(), place_.end(), IM_COL32(40, 43, 46, 255));
  }
  drawScene(list, place_, ticks_.last(), desk.pointer);
  const std::string status = statusLine(ticks_.last(), desk);
  list.AddText({0.5F * ImGui::GetFontSize(), 0.4F * ImGui::GetFontSize()},
               IM_COL32(235, 235, 235, 255), status.c_str());
}

cv::Mat ViewerWindow::pixels() const {
  cv::Size size;
  SDL_GetRendererOutputSize(gui_->renderer, &size.width, &size.height);
  cv::Mat picture(size, CV_8UC3);
  const bool read = SDL_RenderReadPixels(gui_->renderer, nullptr, SDL_PIXELFORMAT_BGR24,
                                         picture.data, static_cast<int>(picture.step)) == 0;
  return read ? picture : cv::Mat();
}

void ViewerWindow::savePicture() {
  save_ = false;
  const std::string file = fmt::format("hapticast-{}.png", ++saved_);
  bool written = false;
  try {
    written = cv::imwrite(file, pixels());
  } catch (const cv::Exception&) {
    written = false;
  }
  state_.note = written ? "saved " + file : file + " cannot be written here";
}

}  // namespace hapticast::client
