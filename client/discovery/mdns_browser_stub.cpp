// SPDX-License-Identifier: MIT
// In a build without Avahi.
#include "client/discovery/mdns_browser.hpp"

namespace hapticast::client {

struct Discovery::Browser {};

Discovery::Discovery() = default;
Discovery::~Discovery() = default;
std::vector<FoundServer> Discovery::servers() const { return {}; }
std::string Discovery::absent() const { return "this build cannot (Avahi)"; }

}  // namespace hapticast::client
