// SPDX-License-Identifier: MIT
#include "client/desk/user_interface.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "client/view/film.hpp"
#include "client/view/screenshot.hpp"
#include "client/view/sound.hpp"
#include "common/cli/run_program.hpp"
#include "common/unique_filename.hpp"
#include "common/write_file.hpp"
#if HAPTICAST_IMGUI
#include "client/view/window/window.hpp"
#endif

namespace hapticast::client {

namespace {

#if HAPTICAST_IMGUI
bool isSet(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

bool hasDisplay() { return isSet("DISPLAY") || isSet("WAYLAND_DISPLAY"); }

/// With auto: where there is a display, and no flag asks for a run without a user.
bool isWanted(const Settings& settings) {
  if (settings.view != ViewChoice::kAuto) return settings.view == ViewChoice::kOn;
  const bool by_itself =
      settings.hand_given || settings.seconds > 0.0 || !settings.screenshot_file.empty();
  return !by_itself && hasDisplay();
}

#endif

/// Opens the window of --view. Returns null where none is wanted or, with auto, none can be opened.
std::unique_ptr<View> openWindow(const Settings& settings) {
#if HAPTICAST_IMGUI
  if (!isWanted(settings)) return nullptr;
  // Without a display, SDL draws into an invisible window.
  if (!hasDisplay() && !isSet("SDL_VIDEODRIVER"))
    throw std::runtime_error("--view on: no display (neither DISPLAY nor WAYLAND_DISPLAY is set)");
  try {
    return std::make_unique<ViewerWindow>(ViewerWindow::kWidth_px, ViewerWindow::kHeight_px,
                                          settings.fullscreen);
  } catch (const std::runtime_error& error) {
    if (settings.view == ViewChoice::kOn)
      throw std::runtime_error(std::string("--view on: ") + error.what());
    spdlog::warn("the client continues without a window: {}", error.what());
    return nullptr;
  }
#else
  if (settings.view == ViewChoice::kOn)
    throw std::runtime_error("--view on: this build has no window (SDL2 and Dear ImGui)");
  return nullptr;
#endif
}

UserControls makeUserControls(const Settings& settings) {
  UserControls user;
  user.static_on = settings.forces != Forces::kDynamic;
  user.dynamic_on = settings.forces != Forces::kStatic;
  user.method = settings.method;
  user.surface = settings.surface;
  return user;
}

bool hasPointer(const Views& views) {
  return std::any_of(views.begin(), views.end(), [](const auto& view) { return view->points(); });
}

}  // namespace

Views openViews(const Settings& settings) {
  Views views;
  if (!settings.screenshot_file.empty()) {
    views.push_back(std::make_unique<Screenshot>(settings.screenshot_file));
    requireWritable("--screenshot", settings.screenshot_file);
  }
  if (!settings.film_file.empty()) {
    views.push_back(std::make_unique<FilmView>(settings.film_file));
    requireWritable("--film", settings.film_file);
  }
#if HAPTICAST_SDL2
  const bool is_study = !settings.study.file.empty();
  const bool has_beeps = is_study && settings.view != ViewChoice::kOff;  // a subject needs a window
  if (settings.sound || has_beeps) {
    try {
      views.push_back(std::make_unique<SoundView>(
          !is_study, [](const std::string& line) { spdlog::warn("--sound: {}", line); }));
    } catch (const std::runtime_error& error) {
      spdlog::warn("{}: the client continues without sound: {}", is_study ? "--study" : "--sound",
                   error.what());
    }
  }
#endif
  if (auto window = openWindow(settings)) views.push_back(std::move(window));
  return views;
}

bool finishViews(const Views& views) {
  bool are_complete = true;
  for (const auto& view : views)
    are_complete = succeed([&view] { view->finish(); }) && are_complete;
  return are_complete;
}

UserInterface::UserInterface(const Settings& settings, Views views)
    : views_(std::move(views)),
      has_pointer_(hasPointer(views_)),
      rearm_(settings.rearm, has_pointer_) {
  state_.user = makeUserControls(settings);
  publishControls();
}

bool UserInterface::wantsVideo() const {
  return std::any_of(views_.begin(), views_.end(),
                     [](const auto& view) { return view->wantsVideo(); });
}

void UserInterface::onPicture(const VideoFrame& picture, const Workspace& workspace) {
  for (const auto& view : views_) view->onPicture(picture, workspace);
}

void UserInterface::onFrame(const PlayableReliefs& frame) {
  for (const auto& view : views_) view->onFrame(frame);
}

void UserInterface::onReport(const TickReport& report) {
  if (recording_) recording_->write(report);
  for (const auto& view : views_) view->onReport(report);
  handleButtons(report.buttons);
  if (!rearm_.onReport(report)) return;
  ++state_.user.rearm_by_itself;
  publishControls();
}

void UserInterface::setRequest(const std::string& text) {
  state_.request = text;
  state_.confirmed = false;
}

bool UserInterface::update(const ConnectionStats& stats) {
  state_.stream = stats;
  bool go_on = true;
  for (const auto& view : views_) go_on = view->update(state_) && go_on;
  if (state_.record != recording_.has_value()) updateRecording();
  pointer_.store(state_.pointer);
  publishControls();
  return go_on;
}

std::optional<Control> UserInterface::takeControl() {
  const TimelineRequest request = std::exchange(state_.timeline, {});
  if (!state_.stream.connected || !state_.stream.timeline) {
    sent_pause_ = false;  // a new connection begins without a pause
    return std::nullopt;
  }
  if (request.seek_s) state_.user.paused = false;
  publishControls();
  Control control;
  control.seek_s = request.seek_s;
  control.speed = request.speed;
  if (state_.user.paused != sent_pause_) control.paused = sent_pause_ = state_.user.paused;
  return control == Control{} ? std::nullopt : std::optional(control);
}

void UserInterface::publishControls() {
  state_.user.number = published_.number;
  if (state_.user == published_) return;
  ++state_.user.number;
  published_ = state_.user;
  if (on_controls_) on_controls_(published_);
  controls_.store(published_);
}

Histogram UserInterface::eyeHand() const {
  Histogram eye_hand;
  for (const auto& view : views_) {
    if (view->eyeHand() != nullptr) eye_hand = *view->eyeHand();
  }
  return eye_hand;
}

bool UserInterface::finish() {
  const bool is_recorded = !recording_ || succeed([this] { recording_->close(); });
  return finishViews(views_) && is_recorded;
}

/// Starts or ends the log that a view asks for while the client runs.
void UserInterface::updateRecording() {
  try {
    if (state_.record) {
      const std::string file = nextFreeFilename(".csv");
      recording_.emplace(file);
      state_.recording = "recording " + file + " (L ends it)";
    } else {
      recording_->close();
      state_.recording = "recorded " + recording_->file();
      recording_.reset();
    }
  } catch (const std::runtime_error& error) {
    state_.recording = error.what();
    state_.record = false;
    recording_.reset();
  }
}

void UserInterface::setStudyPrompt(StudyPrompt prompt) {
  state_.study = std::move(prompt);
  const bool stop = state_.study_input.stop;
  state_.study_input = {};
  state_.study_input.stop = stop;  // no prompt may hide it
}

void UserInterface::setControls(const UserControls& controls) {
  state_.user = controls;
  publishControls();
}

void UserInterface::enterButtons(std::uint32_t buttons) {
  std::uint32_t pressed = buttons & ~std::exchange(study_buttons_, buttons);
  if (enable_button_) pressed &= ~(1U << static_cast<unsigned>(*enable_button_));
  if (pressed != 0 && !state_.study->text.empty())
    enterButton(*state_.study, std::countr_zero(pressed), state_.study_input);
}

void UserInterface::handleButtons(std::uint32_t buttons) {
  if (state_.study) return enterButtons(buttons);
  if (!buttons_) return;
  const DeviceButtons::ButtonActions actions = buttons_->onButtons(buttons);
  if (actions.pause) state_.user.paused = !state_.user.paused;
  if (actions.rearm) ++state_.user.rearm;
  if (actions.pause || actions.rearm) publishControls();
  if (actions.other) spdlog::info("button {} of the device was pressed", *actions.other);
}

}  // namespace hapticast::client
