// SPDX-License-Identifier: MIT
// User interface of the client. It owns the views, the user's controls (which the views and the
// device's buttons change), and the policy that re-arms the force.
// Thread: main, except where a function states another one.
#pragma once

#include <optional>

#include "client/device/buttons.hpp"
#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/report/tick_log.hpp"
#include "client/settings/settings.hpp"
#include "client/view/view.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

/// Opens the views that the command line requests: window, screenshot, film, sound. Throws
/// std::runtime_error with one line that names the flag.
[[nodiscard]] Views openViews(const Settings& settings);
/// Ends the views, which write their files. Returns false if a file is not complete; the log has a
/// line for each.
[[nodiscard]] bool finishViews(const Views& views);

class UserInterface {
 public:
  /// `settings` has the initial controls and the policy of re-arming.
  UserInterface(const Settings& settings, Views views);

  /// Returns the target of the pointer. A view writes it, and only the device may read it. Returns
  /// null if no view has a pointer.
  [[nodiscard]] LatestValue<PointerTarget>* pointer() { return has_pointer_ ? &pointer_ : nullptr; }
  /// Returns true if a window is open, so that a user can confirm a request.
  [[nodiscard]] bool hasWindow() const { return has_pointer_; }
  /// Sets a function that receives all controls, before the renderer reads them. It receives the
  /// present ones at once.
  void onControls(std::function<void(const UserControls&)> on_controls) {
    on_controls_ = std::move(on_controls);
    on_controls_(state_.user);
  }
  /// Returns the controls of the user, which the renderer reads.
  [[nodiscard]] LatestValue<UserControls>& controls() { return controls_; }
  /// Assigns the functions of the device's buttons according to `profile`. `follows_pointer` is
  /// true if the pointer moves the device.
  void setDevice(const DeviceProfile& profile, bool follows_pointer) {
    buttons_.emplace(profile);
    enable_button_ = profile.enable_button;
    state_.pointer_is_device = follows_pointer;
  }
  /// Returns true if a view needs the stream's pictures.
  [[nodiscard]] bool wantsVideo() const;
  [[nodiscard]] const RearmPolicy& rearm() const { return rearm_; }

  /// Shows `text` in the views, as a request or as a state before the first force; empty: nothing.
  void setRequest(const std::string& text);
  /// Returns true if the user has confirmed the request in a view.
  [[nodiscard]] bool confirmed() const { return state_.confirmed; }

  /// Shows a prompt of a study, and forgets the input of the prompt before it.
  void setStudyPrompt(StudyPrompt prompt);
  /// Returns what the subject has entered since the last prompt.
  [[nodiscard]] const StudyInput& studyInput() const { return state_.study_input; }
  /// Forgets a request to stop, after it was carried out.
  void clearStop() { state_.study_input.stop = false; }
  /// Replaces the controls of the user, but not their number.
  void setControls(const UserControls& controls);
  /// Sets how much earlier than the force the picture comes.
  void setPictureAhead(Duration ahead) { state_.picture_ahead = ahead; }
  [[nodiscard]] const UserControls& userControls() const { return state_.user; }
  /// Plays a beep in the views with sound.
  void beep() { ++state_.beeps; }

  /// Pass a picture and the reliefs of a frame to all views. Thread: network.
  void onPicture(const VideoFrame& picture, const Workspace& workspace);
  void onFrame(const PlayableReliefs& frame);
  /// Passes the report of a tick to all views and to the log file that a view has requested.
  /// Carries out the functions of the device's buttons, and re-arms the force if the policy
  /// requires it.
  void onReport(const TickReport& report);
  /// Runs the views' part of the event loop, and publishes the user's controls. `stats` is the
  /// state of the connection. Returns false if the user ends the client in a view.
  [[nodiscard]] bool update(const ConnectionStats& stats);
  /// Returns what the user wants of a stream with a time line: a pause, a place, a speed. A seek
  /// ends the pause. Returns nullopt if there is nothing new.
  [[nodiscard]] std::optional<Control> takeControl();
  /// Returns the histogram of View::eyeHand(): the difference in play time between the shown
  /// picture and the rendered frame, ns. It is empty if no view shows a live picture.
  [[nodiscard]] Histogram eyeHand() const;
  /// Closes the log file of a view, and ends the views as finishViews() does.
  [[nodiscard]] bool finish();

 private:
  /// Passes changed controls on.
  void publishControls();
  void updateRecording();
  void handleButtons(std::uint32_t buttons);
  void enterButtons(std::uint32_t buttons);

  Views views_;
  bool has_pointer_;
  LatestValue<PointerTarget> pointer_;
  UserControls published_;  // equal to the renderer's initial value at first
  LatestValue<UserControls> controls_;
  std::function<void(const UserControls&)> on_controls_;
  UiState state_;
  bool sent_pause_ = false;           // of the stream with a time line
  std::optional<LogFile> recording_;  // started in a view
  RearmPolicy rearm_;
  std::optional<DeviceButtons> buttons_;
  std::optional<int> enable_button_;  // it answers no question
  std::uint32_t study_buttons_ = 0;   // that were down at the last report
};

}  // namespace hapticast::client
