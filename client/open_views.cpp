// SPDX-License-Identifier: MIT
#include "client/open_views.hpp"

#include <spdlog/spdlog.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "client/view/film.hpp"
#include "client/view/screenshot.hpp"
#include "client/view/sound.hpp"
#include "common/build_options.hpp"
#if HAPTICAST_IMGUI
#include "client/view/window/window.hpp"
#endif

namespace hapticast::client {

namespace {

#if HAPTICAST_IMGUI
bool named(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

bool hasDisplay() { return named("DISPLAY") || named("WAYLAND_DISPLAY"); }

/// With auto: where there is a display, and no flag asks for a run without a user.
bool wantedBy(const Settings& settings) {
  if (settings.view != ViewChoice::kAuto) return settings.view == ViewChoice::kOn;
  const bool by_itself =
      settings.hand_given || settings.seconds > 0.0 || !settings.screenshot_file.empty();
  return !by_itself && hasDisplay();
}

#endif

/// Opens the window of --view. Returns null where none is wanted or, with auto, none can be opened.
std::unique_ptr<View> openWindow(const Settings& settings) {
#if HAPTICAST_IMGUI
  if (!wantedBy(settings)) return nullptr;
  // SDL would draw where nobody sees it.
  if (!hasDisplay() && !named("SDL_VIDEODRIVER"))
    throw std::runtime_error("--view on: no display (neither DISPLAY nor WAYLAND_DISPLAY is set)");
  try {
    return std::make_unique<ViewerWindow>();
  } catch (const std::runtime_error& error) {
    if (settings.view == ViewChoice::kOn)
      throw std::runtime_error(std::string("--view on: ") + error.what());
    spdlog::warn("going on without a window: {}", error.what());
    return nullptr;
  }
#else
  if (settings.view == ViewChoice::kOn)
    throw std::runtime_error("--view on: this build has no window (SDL2 and Dear ImGui)");
  return nullptr;
#endif
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
  if (settings.sound) {
    try {
      views.push_back(std::make_unique<SoundView>(
          [](const std::string& line) { spdlog::warn("--sound: {}", line); }));
    } catch (const std::runtime_error& error) {
      spdlog::warn("--sound: going on without: {}", error.what());
    }
  }
#endif
  if (auto window = openWindow(settings)) views.push_back(std::move(window));
  return views;
}

}  // namespace hapticast::client
