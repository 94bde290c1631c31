// SPDX-License-Identifier: MIT
// The view of --screenshot: the strongest touch of a run, its picture and the force of the last
// minute, written to a file at the end. Thread: takePicture() any, everything else main.
#pragma once

#include <memory>
#include <string>

#include "client/view/force_history.hpp"
#include "client/view/picture_buffer.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class Screenshot final : public View {
 public:
  /// Throws std::runtime_error unless `file` ends as a picture does, such as .png.
  explicit Screenshot(std::string file);

  void onPicture(VideoFrame picture, const Workspace& workspace) override;
  void onReport(const TickReport& report) override;
  /// Finds the picture of the strongest moment while it is still in the buffer.
  [[nodiscard]] bool update(UiState& ui_state) override;
  void finish() override;

  /// The strongest touch so far; while nothing was touched, the last tick.
  [[nodiscard]] const TickReport& moment() const { return moment_; }

 private:
  void findPicture();

  std::string file_;
  PictureBuffer pictures_;
  ForceHistory history_;
  TickReport moment_;
  std::shared_ptr<const StreamPicture> picture_;  // of moment_, once it is found
};

}  // namespace hapticast::client
