// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <stdexcept>

#include "client/open_views.hpp"
#include "client/view/window/window.hpp"

namespace hapticast::client {

namespace {

bool named(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

bool hasDisplay() { return named("DISPLAY") || named("WAYLAND_DISPLAY"); }

/// Where somebody may sit and look, and has not asked for a run by itself.
bool isWantedBy(const Settings& settings) {
  if (settings.view != ViewChoice::kAuto) return settings.view == ViewChoice::kOn;
  const bool by_itself =
      settings.hand_given || settings.seconds > 0.0 || !settings.screenshot_file.empty();
  return !by_itself && hasDisplay();
}

}  // namespace

std::unique_ptr<View> openWindow(const Settings& settings) {
  if (!isWantedBy(settings)) return nullptr;
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
}

}  // namespace hapticast::client
