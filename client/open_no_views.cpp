// SPDX-License-Identifier: MIT
#include "client/open_views.hpp"

namespace hapticast::client {

Views openViews(const Settings& settings) {
  (void)openWindow(settings);
  return {};
}

}  // namespace hapticast::client
