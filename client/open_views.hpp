// SPDX-License-Identifier: MIT
// The table of views: window, screenshot, film, sound.
#pragma once

#include "client/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// Opens the views that the command line asks for. Throws std::runtime_error, one line that names
/// the flag. Thread: main.
[[nodiscard]] Views openViews(const Settings& settings);

}  // namespace hapticast::client
