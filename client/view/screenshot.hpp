// SPDX-License-Identifier: MIT
// The view of --screenshot: the strongest contact of a run with its picture and the force of the
// last minute, written at the end.
// Thread: onPicture() any, everything else main.
#pragma once

#include <memory>
#include <string>

#include "client/view/force_plot.hpp"
#include "client/view/picture.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class Screenshot final : public View {
 public:
  /// Throws std::runtime_error unless the extension of `file` is a picture format, such as .png.
  explicit Screenshot(std::string file);

  void onPicture(VideoFrame picture, const Workspace& workspace) override;
  void onReport(const TickReport& report) override;
  /// Fetches the picture of the strongest moment before the buffer drops it.
  [[nodiscard]] bool update(UiState& ui_state) override;
  void finish() override;

  /// Report of the strongest contact so far; without a contact, of the last tick.
  [[nodiscard]] const TickReport& moment() const { return moment_; }

 private:
  void findPicture();

  std::string file_;
  PictureBuffer pictures_;
  ForceHistory history_;
  TickReport moment_;
  std::shared_ptr<const StreamPicture> picture_;  // picture of moment_, once available
};

}  // namespace hapticast::client
