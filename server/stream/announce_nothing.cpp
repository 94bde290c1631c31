// SPDX-License-Identifier: MIT
// Replacement for announce.cpp in a build without Avahi; its command line has no --announce.
#include "server/stream/announce.hpp"

namespace hapticast::server {

struct Announcer::Service {};

void requireReachable(const asio::ip::address& /*address*/) {}

Announcer::Announcer(std::string /*name*/, const asio::ip::tcp::endpoint& /*listens*/,
                     const std::string& /*plays*/) {}

Announcer::~Announcer() = default;

}  // namespace hapticast::server
