// SPDX-License-Identifier: MIT
// A real server on 127.0.0.1 and what talks to it, on one io_context that the test drives.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/net/connection.hpp"
#include "client/net/inline_preparation.hpp"
#include "common/transport/asio.hpp"
#include "server/page/page_responder.hpp"
#include "server/stream/listener.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/framed.hpp"
#include "tests/support/patient_clock.hpp"

namespace hapticast::testing {

/// A server's stream half: listener and broadcaster.
struct TestServer {
  TestServer(asio::io_context& io, const Clock& clock, server::StreamSettings settings = {},
             std::uint16_t port = 0, const std::string& host = "127.0.0.1",
             std::optional<TlsContext> tls = std::nullopt,
             std::span<const server::PageFile> page_files = server::listPageFiles())
      : media(clock),
        broadcaster(io, clock, media, description(), settings),
        page({"localhost"}, page_files),
        listener(io, {host, port}, broadcaster, std::move(tls), &page) {
    listener.start();
  }

  [[nodiscard]] std::uint16_t port() const { return listener.address().port; }

  static StreamDescription description() {
    StreamDescription description;
    description.name = "test";
    return description;
  }
  void stop() {
    listener.stop();
    broadcaster.stop();
  }
  /// Publishes a frame with one object whose relief is `side` x `side` px, flat where it is small
  /// and noise where it has to be many bytes, and changes in every frame or never.
  void publish(std::uint64_t id, int side = 8, bool changes = true) {
    HapticFrame frame;
    frame.id = id;
    frame.media_time = media.now();
    frame.objects.push_back({1,
                             0,
                             changes ? id : 1,
                             side < 200 ? flatRelief({0, 0, side, side}) : noise(side),
                             {},
                             nullptr,
                             {},
                             {}});
    broadcaster.publish(encoder.encode(frame));
  }

  /// The same one again, so that it is coded once.
  std::shared_ptr<const Relief> noise(int side) {
    if (noise_ && noise_->rect.width == side) return noise_;
    auto relief = flatRelief({0, 0, side, side});
    std::mt19937 random(3);
    std::uniform_real_distribution<float> height(0.0F, 30.0F);
    for (float& each : relief->height_mm) each = height(random);
    return noise_ = relief;
  }

  LocalMediaClock media;
  server::Broadcaster broadcaster;
  server::PageResponder page;
  server::Listener listener;
  server::FrameEncoder encoder;

 private:
  std::shared_ptr<const Relief> noise_;
};

/// A hand-made peer: sends any bytes, reads what comes when asked to.
class RawPeer {
 public:
  /// `from`: the last number of its own address 127.0.0.x.
  RawPeer(asio::io_context& io, std::uint16_t port, std::uint8_t from = 1)
      : RawPeer(io, {asio::ip::address_v4::loopback(), port},
                asio::ip::address_v4({127, 0, 0, from})) {}
  RawPeer(asio::io_context& io, const asio::ip::tcp::endpoint& to, const asio::ip::address& from)
      : socket_(io) {
    socket_.open(to.protocol());
    socket_.bind({from, 0});
    socket_.connect(to);
    socket_.non_blocking(true);
  }
  explicit RawPeer(asio::ip::tcp::socket socket) : socket_(std::move(socket)) {
    socket_.non_blocking(true);
  }
  void send(const std::vector<std::uint8_t>& bytes) {
    boost::system::error_code ignored;  // the other side may have closed already
    asio::write(socket_, asio::buffer(bytes), ignored);
  }
  void send(const Message& message) { send(framed(encode(message))); }
  /// Ends its own side: it sends nothing more, but reads.
  void finish() { socket_.shutdown(asio::socket_base::shutdown_send); }
  /// Takes what has arrived.
  void poll() {
    std::vector<std::uint8_t> chunk(1U << 16U);
    boost::system::error_code ec;
    while (!closed) {
      const std::size_t size = socket_.read_some(asio::buffer(chunk), ec);
      if (ec == asio::error::would_block) return;
      if (ec) {
        closed = true;
        reset = ec != asio::error::eof;
        return;
      }
      received_bytes += size;
      reader_.feed(std::span(chunk).first(size));
      for (auto next = reader_.next(); next.ok() && next.value(); next = reader_.next()) {
        got.push_back(decode(*next.value()).value());
        if (keeps_payloads) payloads.emplace_back(next.value()->begin(), next.value()->end());
      }
    }
  }
  template <class T>
  [[nodiscard]] std::vector<T> all() const {
    std::vector<T> found;
    for (const Message& each : got) {
      if (const T* const match = std::get_if<T>(&each)) found.push_back(*match);
    }
    return found;
  }

  std::vector<Message> got;
  bool keeps_payloads = false;
  std::vector<std::vector<std::uint8_t>> payloads;  // of the same messages
  bool closed = false;
  bool reset = false;
  std::size_t received_bytes = 0;

 private:
  asio::ip::tcp::socket socket_;
  LengthFraming reader_{kMaxMessageBytes};
};

/// A whole client's network half, with the loop's side of the pool.
struct TestClient {
  TestClient(asio::io_context& io, const Clock& clock, std::uint16_t port,
             const std::function<void(client::ConnectionSettings&)>& change = {})
      : preparation(*pool, clock, Method::kHapticast,
                    [this](const client::PreparedFrame& frame) { receiver.addPrepared(frame); }),
        connection(io, clock, settings(port, change), receiver, events()) {
    connection.start();
  }

  static client::ConnectionSettings settings(
      std::uint16_t port, const std::function<void(client::ConnectionSettings&)>& change) {
    client::ConnectionSettings settings;
    settings.server.port = port;
    settings.burst_interval = std::chrono::milliseconds(1);
    settings.ping_interval = std::chrono::milliseconds(50);
    settings.first_retry = std::chrono::milliseconds(10);
    settings.last_retry = std::chrono::milliseconds(50);
    if (change) change(settings);
    return settings;
  }
  client::ConnectionEvents events() {
    return {[this](const StreamDescription&) { ++welcomes; },
            [this](VideoFrame frame) { videos.push_back(std::move(frame)); },
            [this](double share) { shares.push_back(share); },
            [this](const std::string& line) { news.push_back(line); },
            [this](const std::string& line) { lost.push_back(line); },
            [this](const std::string& line) { failure = line; }};
  }
  /// What the loop would do: takes every frame and gives it back.
  void drain() {
    while (preparation.step()) {
    }
    client::FramePool::Index index = 0;
    while (pool->pop(index)) {
      frames.push_back({pool->frame(index).epoch, pool->frame(index).id});
      last_has_field =
          pool->frame(index).object_count > 0 && pool->frame(index).objects[0].field != nullptr;
      pool->release(index);
    }
  }

  std::unique_ptr<client::FramePool> pool = std::make_unique<client::FramePool>();
  LatestValue<client::StreamTiming> stream;
  client::InlinePreparation preparation;  // its steps are the test's
  client::Receiver receiver{preparation, stream, 1};
  std::vector<std::pair<std::uint32_t, std::uint64_t>> frames;  // epoch, id
  bool last_has_field = false;
  std::vector<VideoFrame> videos;
  std::vector<double> shares;
  std::vector<std::string> lost;
  std::vector<std::string> news;  // of how frames come
  std::string failure;
  int welcomes = 0;
  client::Connection connection;
};

class StreamTest : public ::testing::Test {
 protected:
  static constexpr int kMostInATurn = 1000;  // what is ready, though one makes the next
  /// Runs everything until `done`; false when it never is.
  bool runUntil(const std::function<bool()>& done) {
    // Against a test that hangs: it judges nothing.
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!done()) {
      if (std::chrono::steady_clock::now() > give_up) return false;
      turn();
    }
    return true;
  }
  /// Whether messages of a kind have come to the peer: `count` of them, or at least one.
  template <class M>
  bool receives(RawPeer& peer, std::optional<std::size_t> count = std::nullopt) {
    return runUntil([&] {
      peer.poll();
      const std::size_t come = peer.all<M>().size();
      return count ? come == *count : come > 0;
    });
  }
  /// Some time passes, in which all that is ready has its turn, however busy the machine is.
  void turn() {
    clock.turn();
    io.restart();
    io.run_for(std::chrono::milliseconds(2));
    io.restart();
    for (int i = 0; i < kMostInATurn && io.poll_one() > 0; ++i) {
    }
  }
  /// A peer that has been welcomed.
  std::unique_ptr<RawPeer> viewer(const TestServer& server, bool wants_video = false) {
    auto peer = std::make_unique<RawPeer>(io, server.port());
    peer->send(Hello{kProtocolVersion, "raw", wants_video, true});
    EXPECT_TRUE(receives<Welcome>(*peer));
    return peer;
  }
  /// The error a peer is sent before it is closed in an orderly way.
  WireError farewell(RawPeer& peer) {
    EXPECT_TRUE(runUntil([&] {
      peer.poll();
      return peer.closed;
    }));
    EXPECT_FALSE(peer.reset) << "the error could have been lost";
    const auto errors = peer.all<WireError>();
    return errors.size() == 1 ? errors[0]
                              : WireError{ErrorCode::kMalformed, "no single error came"};
  }

  PatientClock clock;
  asio::io_context io;
};

}  // namespace hapticast::testing
