// SPDX-License-Identifier: MIT
#include <stdexcept>

#include "client/open_views.hpp"

namespace hapticast::client {

std::unique_ptr<View> openWindow(const Settings& settings) {
  if (settings.view == ViewChoice::kOn)
    throw std::runtime_error("--view on: this build has no window (SDL2 and Dear ImGui)");
  return nullptr;
}

}  // namespace hapticast::client
