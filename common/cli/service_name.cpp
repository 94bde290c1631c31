// SPDX-License-Identifier: MIT
#include "common/cli/service_name.hpp"

#include <CLI/CLI.hpp>

#include "common/build_options.hpp"
#include "common/mdns.hpp"
#include "common/text.hpp"

namespace hapticast {

void requireDiscovery(const std::string& flag) {
  if (!kHasDiscovery)
    throw CLI::ValidationError(flag, "this build announces and finds no servers (Avahi)");
}

std::string serviceName(const std::string& flag, const std::string& text) {
  requireDiscovery(flag);
  if (!isServiceName(text)) {
    throw CLI::ValidationError(flag, quote(sanitizeUtf8(text)) +
                                         " is not a name of 1 to 63 bytes of UTF-8 without control "
                                         "characters");
  }
  return text;
}

}  // namespace hapticast
