// SPDX-License-Identifier: MIT
// The window. It shows the video at play time with the HIP and the forces, and a panel with
// controls. Its pointer can move the HIP (device `mouse`).
// Thread: onPicture() and onFrame() any, everything else main.
#pragma once

#include <SDL.h>

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "client/view/painter.hpp"
#include "client/view/picture.hpp"
#include "client/view/pointer_input.hpp"
#include "client/view/window/layout.hpp"
#include "client/view/window/panel.hpp"
#include "client/view/window/relief.hpp"

namespace hapticast::client {

class ViewerWindow final : public View {
 public:
  static constexpr int kWidth_px = 1280;
  static constexpr int kHeight_px = 720;

  /// Opens the window and draws it once. `fullscreen`: it fills the screen. Throws
  /// std::runtime_error (one line) if there is no display.
  explicit ViewerWindow(int width_px = kWidth_px, int height_px = kHeight_px,
                        bool fullscreen = false);
  ViewerWindow(const ViewerWindow&) = delete;
  ViewerWindow& operator=(const ViewerWindow&) = delete;
  ~ViewerWindow() override;

  void onPicture(VideoFrame picture, const Workspace& workspace) override;
  void onFrame(const PlayableReliefs& frame) override { relief_.onFrame(frame); }
  void onReport(const TickReport& report) override;
  /// Processes the user's input, and draws if it is time for the next drawing. Returns false if the
  /// user has closed the window.
  [[nodiscard]] bool update(UiState& ui_state) override;
  /// Throws std::runtime_error if the display has removed the window.
  void finish() override;
  [[nodiscard]] bool points() const override { return true; }
  [[nodiscard]] const Histogram* eyeHand() const override { return &eye_hand_ns_; }

  /// Draws the window now.
  void draw(UiState& ui_state);
  /// Returns the last drawing as a CV_8UC3 picture.
  [[nodiscard]] cv::Mat pixels() const;
  /// Returns the position of the video in the last drawing.
  [[nodiscard]] const ScenePlace& place() const { return place_; }

 private:
  void handleEvent(const SDL_Event& event, UiState& ui_state);
  void point(const SDL_MouseMotionEvent& motion, UiState& ui_state);
  enum class Drag : std::uint8_t { kNone, kPresses, kTurns, kMoves };
  void pressButton(const Vec2& cursor);
  void drag(Drag what);
  /// Returns the part of the relief's box at `point`. It is kNone while the box is closed.
  [[nodiscard]] BoxPart findPart(const Vec2& point) const;
  void present();
  void selectPicture(Duration ahead);
  [[nodiscard]] cv::Mat paintScene(const PointerTarget& pointer, bool is_study);
  void showScene(const WindowLayout& layout, const UiState& ui_state);
  void showTexts(const WindowLayout& layout, const UiState& ui_state);
  void savePicture();
  void toggleFullscreen();

  struct Gui;  // SDL, ImGui and their resources, in the order of their destruction
  std::unique_ptr<Gui> gui_;
  PictureBuffer pictures_;
  std::shared_ptr<const StreamPicture> shown_;
  cv::Mat picture_;  // of shown_; empty before the first one
  Workspace workspace_;
  ForceHistory history_;
  TickStatus ticks_;
  PanelState state_;
  ScenePlace place_;
  bool placed_ = false;  // place_ is that of the stream's picture
  PointerInput input_;
  Drag drag_ = Drag::kNone;
  WindowRelief relief_;
  Histogram eye_hand_ns_;
  MediaTime last_play_time_{};
  bool closed_ = false;
  bool save_ = false;
  std::uint64_t drawn_ms_ = 0;
};

}  // namespace hapticast::client
