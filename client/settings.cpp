// SPDX-License-Identifier: MIT
#include "client/settings.hpp"

#include <fstream>
#include <stdexcept>

namespace hapticast::client {

void requireWritable(const char* flag, const std::string& file) {
  if (file.empty() || std::ofstream(file, std::ios::app)) return;
  throw std::runtime_error(std::string(flag) + " " + file +
                           ": cannot be written; is its folder there and writable?");
}

}  // namespace hapticast::client
