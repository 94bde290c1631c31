// SPDX-License-Identifier: MIT
// The view of --screenshot. It shows the strongest contact of a run, with the picture of that time
// and the force of the last minute. It writes its file at the end of the run.
// Thread: onPicture() any, everything else main.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "client/view/force_plot.hpp"
#include "client/view/picture.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class Screenshot final : public View {
 public:
  /// Stores the name of the file, which finish() writes.
  explicit Screenshot(std::string file) : file_(std::move(file)) {}

  void onPicture(VideoFrame picture, const Workspace& workspace) override;
  void onReport(const TickReport& report) override;
  /// Stores the picture of the strongest contact so far, before the buffer drops it. Always returns
  /// true.
  [[nodiscard]] bool update(UiState& ui_state) override;
  void finish() override;

  /// Returns the report of the tick with the strongest contact so far. Without a contact it is the
  /// report of the last tick.
  [[nodiscard]] const TickReport& moment() const { return moment_; }

 private:
  void findPicture();

  std::string file_;
  PictureBuffer pictures_;
  ForceHistory history_;
  TickReport moment_;
  UserControls user_;
  std::shared_ptr<const StreamPicture> picture_;  // picture of moment_, once available
};

}  // namespace hapticast::client
