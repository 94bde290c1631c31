// SPDX-License-Identifier: MIT
// The table of views. A build without the viewer has open_no_views.cpp in the place of
// open_views.cpp (client/CMakeLists.txt).
#pragma once

#include "client/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// The views that the command line asks for. Throws std::runtime_error, one line that names the
/// flag.
[[nodiscard]] Views openViews(const Settings& settings);

/// The window of --view; null where none is wanted or, with auto, none can be. Throws as
/// openViews() does. A build without its libraries has open_no_window.cpp in the place of
/// open_window.cpp.
[[nodiscard]] std::unique_ptr<View> openWindow(const Settings& settings);

}  // namespace hapticast::client
