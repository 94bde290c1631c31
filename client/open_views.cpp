// SPDX-License-Identifier: MIT
#include "client/open_views.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "client/view/film.hpp"
#include "client/view/screenshot.hpp"
#include "client/view/sound.hpp"

namespace hapticast::client {

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
#ifdef HAPTICAST_SOUND
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
