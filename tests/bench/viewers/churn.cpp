// SPDX-License-Identifier: MIT
#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"
#include "common/transport/framing.hpp"
#include "tests/bench/viewers/trials.hpp"
#include "tests/support/framed.hpp"

namespace hapticast::testing {

namespace {

using asio::ip::tcp;
using asio::ip::udp;
constexpr double kLife_s = 10.0;
constexpr double kKilled = 0.05;
constexpr auto kEchoAgain = std::chrono::milliseconds(200);
constexpr Duration kApart =
    std::chrono::milliseconds(10);         // servers keep only so many pending clients
constexpr std::size_t kLeaving = 32;       // places of those that the server has not seen leave yet
constexpr std::size_t kRemembered = 4096;  // frames or datagrams, some seconds

struct Tally {
  std::uint64_t opened = 0, killed = 0, frames = 0, datagrams = 0, wrong = 0, closed = 0;
};

std::size_t hashOf(std::span<const std::uint8_t> bytes) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

class Churn {
 public:
  Churn(asio::io_context& io, std::uint16_t port, bool by_udp)
      : io_(io), server_(asio::ip::address_v4::loopback(), port), by_udp_(by_udp) {}

  void start(std::size_t viewers) {
    for (std::size_t i = 0; i < viewers; ++i) {
      asio::co_spawn(
          io_, [this, i] { return comeAndGo(static_cast<Duration::rep>(i) * kApart); },
          asio::detached);
    }
  }
  [[nodiscard]] const Tally& tally() const { return tally_; }

 private:
  struct Viewer {
    explicit Viewer(asio::io_context& io) : socket(io), datagrams(io), timer(io) {}
    tcp::socket socket;
    udp::socket datagrams;
    asio::steady_timer timer;
    Welcome welcome;
    std::uint64_t newest = 0;
    bool over = false;
  };
  using ViewerPtr = std::shared_ptr<Viewer>;

  asio::awaitable<void> comeAndGo(Duration after) {
    asio::steady_timer timer(io_);
    timer.expires_after(after);
    co_await timer.async_wait(asio::use_awaitable);
    for (;;) {
      const auto viewer = std::make_shared<Viewer>(io_);
      boost::system::error_code ec;
      co_await viewer->socket.async_connect(server_, asio::redirect_error(asio::use_awaitable, ec));
      if (ec) {
        std::printf("cannot connect: %s\n", ec.message().c_str());
        ++tally_.closed;
        timer.expires_after(std::chrono::seconds(1));
        co_await timer.async_wait(asio::use_awaitable);
        continue;
      }
      ++tally_.opened;
      say(*viewer, Hello{kProtocolVersion, "churn", false, !by_udp_});
      asio::co_spawn(
          io_, [this, viewer] { return readAll(viewer); }, asio::detached);
      co_await live(*viewer);
      viewer->over = true;
      if (std::bernoulli_distribution(kKilled)(random_)) {
        // Half a message is on the way to the server, and what it has sent is not read.
        ++tally_.killed;
        const auto ping = framed(encode(Ping{}));
        asio::write(viewer->socket, asio::buffer(ping.data(), ping.size() / 2), ec);
        viewer->socket.set_option(asio::socket_base::linger(true, 0), ec);
      }
      viewer->socket.close(ec);
      viewer->datagrams.close(ec);
    }
  }

  asio::awaitable<void> live(Viewer& viewer) {
    const auto end =
        clock_.now() + fromSeconds(std::exponential_distribution(1.0 / kLife_s)(random_));
    LocalTime next_ping = clock_.now(), next_echo = next_ping;
    for (LocalTime now = clock_.now(); now < end && !viewer.over; now = clock_.now()) {
      if (now >= next_ping) {
        say(viewer, Ping{now});
        next_ping = now + std::chrono::seconds(1);
      }
      if (now >= next_echo && viewer.datagrams.is_open()) {
        boost::system::error_code ec;
        viewer.datagrams.send(
            asio::buffer(echoBytes({viewer.welcome.datagram_token, viewer.welcome.stream})), 0, ec);
        next_echo = now + std::chrono::seconds(5);
      }
      boost::system::error_code ec;
      viewer.timer.expires_after(std::min<Duration>(end - now, kEchoAgain));
      co_await viewer.timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    }
  }

  asio::awaitable<void> readAll(ViewerPtr viewer) {
    LengthFraming reader(kMaxMessageBytes);
    std::vector<std::uint8_t> chunk(1U << 16U);
    for (;;) {
      boost::system::error_code ec;
      const std::size_t size = co_await viewer->socket.async_read_some(
          asio::buffer(chunk), asio::redirect_error(asio::use_awaitable, ec));
      if (viewer->over) co_return;
      if (ec) {
        ++tally_.closed;
        viewer->over = true;
        co_return;
      }
      reader.feed(std::span(chunk).first(size));
      auto next = reader.next();
      for (; next.ok() && next.value(); next = reader.next()) take(viewer, *next.value());
      if (!next.ok()) ++tally_.wrong;
    }
  }

  void take(const ViewerPtr& viewer, std::span<const std::uint8_t> payload) {
    if (const auto head = frameHead(payload)) {
      ++tally_.frames;
      if (head->id <= viewer->newest) ++tally_.wrong;
      viewer->newest = head->id;
      (void)compare({head->id, 0}, hashOf(payload));
      return;
    }
    const auto message = decode(payload);
    if (!message.ok()) {
      ++tally_.wrong;
    } else if (const auto* const error = std::get_if<WireError>(&message.value())) {
      std::printf("the server says: %s\n", error->message.c_str());  // and closes
    } else if (const auto* const welcome = std::get_if<Welcome>(&message.value())) {
      viewer->welcome = *welcome;
      if (by_udp_) openDatagrams(viewer);
    }
  }

  void openDatagrams(const ViewerPtr& viewer) {
    viewer->datagrams.open(udp::v4());
    viewer->datagrams.connect({server_.address(), server_.port()});
    say(*viewer, Delivery{false, true, 1});
    asio::co_spawn(
        io_, [this, viewer] { return readDatagrams(viewer); }, asio::detached);
    viewer->timer.cancel();  // its first echo goes now
  }

  asio::awaitable<void> readDatagrams(ViewerPtr viewer) {
    std::array<std::uint8_t, 2 * kMostDatagramBytes> bytes{};
    for (;;) {
      boost::system::error_code ec;
      const std::size_t size = co_await viewer->datagrams.async_receive(
          asio::buffer(bytes), asio::redirect_error(asio::use_awaitable, ec));
      if (ec || viewer->over) co_return;
      const auto datagram = readDatagram(std::span(bytes).first(size));
      if (!datagram || datagram->token != viewer->welcome.datagram_token) {
        ++tally_.wrong;
      } else if (!datagram->header.probe()) {
        ++tally_.datagrams;
        const bool first = compare({datagram->header.frame, datagram->header.part},
                                   hashOf(std::span(bytes).first(size).subspan(kTokenBytes)));
        const auto key = VerifyingKey::from(viewer->welcome.verifying_key.value());
        if (first && !key.value().verify(datagram->signed_bytes, datagram->signature))
          ++tally_.wrong;
      }
    }
  }

  /// Whether nobody has had it before.
  bool compare(const std::pair<std::uint64_t, std::uint16_t>& what, std::size_t hash) {
    const auto [known, first] = seen_.emplace(what, hash);
    if (known->second != hash) ++tally_.wrong;
    if (seen_.size() > kRemembered) seen_.erase(seen_.begin());
    return first;
  }

  static void say(Viewer& viewer, const Message& message) {
    boost::system::error_code ended;  // who reads sees that as well
    asio::write(viewer.socket, asio::buffer(framed(encode(message))), ended);
  }

  asio::io_context& io_;
  tcp::endpoint server_;
  bool by_udp_;
  SteadyClock clock_;
  std::mt19937 random_{7};
  std::map<std::pair<std::uint64_t, std::uint16_t>, std::size_t> seen_;
  Tally tally_;
};

std::size_t openFiles(pid_t pid) {
  std::error_code ec;
  const std::filesystem::directory_iterator files("/proc/" + std::to_string(pid) + "/fd", ec);
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

}  // namespace

void churn(Contestant who, const Frames& frames, Duration time) {
  Frames places = frames;
  places.viewers += kLeaving;
  Switch playing;
  playing.set(true);
  const ServerProcess server(broadcaster(places, playing));
  const std::size_t files_before = openFiles(server.id());
  const SteadyClock clock;
  const LocalTime begin = clock.now();
  Tally all;
  {
    asio::io_context io;
    Churn viewers(io, server.port(), who == Contestant::kUdp);
    viewers.start(frames.viewers);
    for (LocalTime next = begin; clock.now() - begin < time;) {
      next += std::min<Duration>(time, std::chrono::minutes(1));
      io.run_for(next - clock.now());
      all = viewers.tally();
      std::printf(
          "%.0f s: %llu came, %llu of them killed in a message; %llu frames, %llu "
          "datagrams, %llu wrong; %llu closed by the server; it has %.1f MB, %zu files\n",
          toSeconds(clock.now() - begin), static_cast<unsigned long long>(all.opened),
          static_cast<unsigned long long>(all.killed), static_cast<unsigned long long>(all.frames),
          static_cast<unsigned long long>(all.datagrams),
          static_cast<unsigned long long>(all.wrong), static_cast<unsigned long long>(all.closed),
          1e-6 * residentBytes(server.id()), openFiles(server.id()));
      std::fflush(stdout);
    }
  }
  const LocalTime gone = clock.now() + std::chrono::seconds(10);
  while (openFiles(server.id()) != files_before && clock.now() < gone)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const std::size_t files = openFiles(server.id());
  std::printf("all have left: %.1f MB, %zu files (%zu before)\n", 1e-6 * residentBytes(server.id()),
              files, files_before);
  if (all.wrong + all.closed > 0 || all.frames + all.datagrams == 0 || files != files_before)
    throw std::runtime_error("the churn has done harm");
}

}  // namespace hapticast::testing
