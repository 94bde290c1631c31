// SPDX-License-Identifier: MIT
// A listener whose messages the test sends itself. Thread: one.
#pragma once

#include <memory>

#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {

/// Accepts one connection at a time and lets the test play the server.
struct FakeServer {
  explicit FakeServer(asio::io_context& io) : acceptor(io, {asio::ip::address_v4::loopback(), 0}) {
    acceptor.non_blocking(true);
  }
  bool accept() {
    boost::system::error_code ec;
    auto socket = acceptor.accept(ec);
    if (ec) return false;
    peer = std::make_unique<RawPeer>(std::move(socket));
    return true;
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor.local_endpoint().port(); }
  asio::ip::tcp::acceptor acceptor;
  std::unique_ptr<RawPeer> peer;
};

}  // namespace hapticast::testing
