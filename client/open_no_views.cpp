// SPDX-License-Identifier: MIT
#include "client/open_views.hpp"

namespace hapticast::client {

Views openViews(const Settings& /*settings*/) { return {}; }

}  // namespace hapticast::client
