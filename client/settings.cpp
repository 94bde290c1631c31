// SPDX-License-Identifier: MIT
#include "client/settings.hpp"

#include <fstream>
#include <stdexcept>

namespace hapticast::client {

bool hasViewer() { return HAPTICAST_HAS_VIEWER != 0; }

bool hasWindow() { return HAPTICAST_HAS_WINDOW != 0; }

bool hasSound() { return HAPTICAST_HAS_SOUND != 0; }

void requireWritable(const char* flag, const std::string& file) {
  if (file.empty() || std::ofstream(file, std::ios::app)) return;
  throw std::runtime_error(std::string(flag) + " " + file +
                           ": cannot be written; is its folder there and writable?");
}

}  // namespace hapticast::client
