// SPDX-License-Identifier: MIT
// The user's side of the client: the views, the controls that the user changes in them or by the
// device's buttons, and the policy that re-arms the force. Thread: main, except where named.
#pragma once

#include <optional>

#include "client/device/buttons.hpp"
#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/report/tick_log.hpp"
#include "client/settings.hpp"
#include "client/view/view.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

/// Opens the views that the command line asks for: window, screenshot, film, sound. Throws
/// std::runtime_error, one line that names the flag.
[[nodiscard]] Views openViews(const Settings& settings);

class UserInterface {
 public:
  UserInterface(const Settings& settings, Views views);

  /// Returns where a view's pointer is; null if no view has one. Its one reader is the device.
  [[nodiscard]] LatestValue<PointerTarget>* pointer() { return has_pointer_ ? &pointer_ : nullptr; }
  /// Returns the controls that the renderer reads.
  [[nodiscard]] LatestValue<UserControls>& controls() { return controls_; }
  /// Sets the buttons of the device.
  void setDevice(const DeviceProfile& profile) { buttons_.emplace(profile); }
  [[nodiscard]] bool wantsVideo() const;
  [[nodiscard]] const RearmPolicy& rearm() const { return rearm_; }

  /// Passes a picture and the frame that it belongs to on to the views. Thread: network.
  void onPicture(const VideoFrame& picture, const Workspace& workspace);
  void onFrame(const PlayableReliefs& frame);
  /// Passes the report of a tick on to the views and the recording, and acts on the device's
  /// buttons.
  void onReport(const TickReport& report);
  /// A turn of the event loop. Returns false when the user ends the client in a view.
  [[nodiscard]] bool update(const ConnectionStats& stats);
  /// Returns the first view's measurement (View::eyeHand()); empty if there is none.
  [[nodiscard]] Histogram eyeHand() const;
  /// Ends recording and views. Throws std::runtime_error, one line that names the file.
  void finish();

 private:
  void updateRecording();
  void handleButtons(std::uint32_t buttons);

  Views views_;
  bool has_pointer_;
  LatestValue<PointerTarget> pointer_;
  LatestValue<UserControls> controls_;
  UiState state_;
  std::optional<LogFile> recording_;  // started in a view
  RearmPolicy rearm_;
  std::optional<DeviceButtons> buttons_;
};

}  // namespace hapticast::client
