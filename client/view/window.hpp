// SPDX-License-Identifier: MIT
// The window: the video at play time with what is felt in it, the controls beside it, and a pointer
// that can be a device. Thread: takePicture() any, everything else main.
#pragma once

#include <SDL.h>

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "client/view/picture_buffer.hpp"
#include "client/view/window_painter.hpp"
#include "client/view/window_panel.hpp"
#include "client/view/window_scene.hpp"

namespace hapticast::client {

class ViewerWindow final : public View {
 public:
  static constexpr int kWidth_px = 1280;
  static constexpr int kHeight_px = 720;

  /// Opens it on SDL's display. Throws std::runtime_error, one line, where there is none.
  explicit ViewerWindow(int width_px = kWidth_px, int height_px = kHeight_px);
  ViewerWindow(const ViewerWindow&) = delete;
  ViewerWindow& operator=(const ViewerWindow&) = delete;
  ~ViewerWindow() override;

  void takePicture(VideoFrame picture, const Workspace& workspace) override;
  void takeReport(const TickReport& report) override;
  /// Hears what the user does; draws when it is time to. False when the window was closed.
  [[nodiscard]] bool turn(Desk& desk) override;
  /// Throws where the display took it away.
  void finish() override;
  [[nodiscard]] bool points() const override { return true; }

  /// Draws now, whatever time it is.
  void draw(Desk& desk);
  /// What was drawn last, CV_8UC3.
  [[nodiscard]] cv::Mat pixels() const;
  /// Where the picture was drawn last.
  [[nodiscard]] const ScenePlace& place() const { return place_; }

 private:
  void hear(const SDL_Event& event, Desk& desk);
  void point(const SDL_MouseMotionEvent& motion, Desk& desk);
  void press(double by_mm, Desk& desk) const;
  void drag(bool begins);
  void showPicture();
  void showScene(Desk& desk);
  void savePicture();

  struct Gui;  // SDL, ImGui and what they own, in the order of their ends
  std::unique_ptr<Gui> gui_;
  PictureBuffer pictures_;
  std::shared_ptr<const StreamPicture> shown_;
  Texture texture_;  // of shown_
  cv::Size texture_size_;
  Workspace workspace_;
  ForceHistory history_;
  TickWatch ticks_;
  PanelState state_;
  ScenePlace place_;
  bool dragging_ = false;
  bool closed_ = false;
  bool save_ = false;
  int saved_ = 0;
  std::uint64_t drawn_ms_ = 0;
};

}  // namespace hapticast::client
