// SPDX-License-Identifier: MIT
// A server that sends datagrams, for tests over loopback.
#pragma once

#include <memory>
#include <optional>

#include "server/stream/datagram_sender.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::testing {

/// A group on this machine alone. The kernel chooses the port.
inline server::MulticastChoice loopbackGroup(const std::string& host) {
  asio::io_context io;
  const asio::ip::udp::socket free(io, {asio::ip::address_v4::loopback(), 0});
  return {{host, free.local_endpoint().port()}, "lo"};
}

/// A server that offers datagrams, and the group, if there is one.
struct DatagramServer : TestServer {
  DatagramServer(asio::io_context& io, const Clock& clock,
                 const std::optional<server::MulticastChoice>& multicast = std::nullopt,
                 const std::string& host = "127.0.0.1", bool seals = false)
      : TestServer(io, clock, {}, 0, host),
        signer(SigningKey(), makeSealer(seals)),
        other(SigningKey(), makeSealer(seals)) {
    if (multicast) group.emplace(io, *multicast, 1);
    sender.emplace(io, clock, listener.endpoint(), signer.identity(), group ? &*group : nullptr);
    broadcaster.introduce(signer.identity());
    broadcaster.enableUdp(*sender);
  }
  /// A frame with an object of `side` px whose relief is in it.
  void publish(std::uint64_t id, int side = 8) {
    HapticFrame frame;
    frame.epoch = 3;
    frame.id = id;
    frame.media_time = media.now();
    frame.objects.push_back({1, 0, id, noise(side), {}, nullptr, {}, {}});
    last = frame;
    if (const auto key = origin->rotateKey()) broadcaster.changeKey(*key);
    broadcaster.publish(encoder.encode(frame, {}, origin, broadcaster.datagramsWanted()));
  }
  /// The other signer makes the stream from now on.
  void changeOrigin(const StreamDescription& described = description()) {
    origin = &other;
    encoder = {};
    broadcaster.changeOrigin(other.identity(), described);
  }
  [[nodiscard]] std::uint64_t echoes(server::AddressValidation verdict) const {
    return sender->counts().of(verdict);
  }

  [[nodiscard]] std::unique_ptr<server::DatagramSealer> makeSealer(bool seals) const {
    return seals ? std::make_unique<server::DatagramSealer>(key_clock) : nullptr;
  }

  ManualClock key_clock;  // of the rotation of keys
  server::FrameSigner signer;
  server::FrameSigner other;
  server::FrameSigner* origin = &signer;
  std::optional<server::MulticastGroup> group;
  std::optional<server::DatagramSender> sender;
  HapticFrame last;
};

}  // namespace hapticast::testing
