// SPDX-License-Identifier: MIT
#include "client/open_views.hpp"

#include <utility>

#include "client/view/film.hpp"
#include "client/view/screenshot.hpp"

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
  if (auto window = openWindow(settings)) views.push_back(std::move(window));
  return views;
}

}  // namespace hapticast::client
