// SPDX-License-Identifier: MIT
#include "tests/bench/viewers/servers.hpp"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/page/page_responder.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/listener.hpp"
#include "tests/support/framed.hpp"

namespace hapticast::testing {

namespace {

/// A relief of about so many bytes on the wire; nobody here decodes it.
std::shared_ptr<const CodedRelief> makeRelief(std::size_t bytes) {
  CodedRelief relief{{0, 0, 640, 480}, {}, 0};
  for (std::size_t left = bytes; left > 0; left -= relief.slices.back().size())
    relief.slices.emplace_back(std::min(left, kMostSliceBytes),
                               static_cast<std::uint8_t>(relief.slices.size() + 1));
  relief.slice_count = relief.slices.size();
  return std::make_shared<const CodedRelief>(std::move(relief));
}

CodedFrame frameWith(std::uint64_t id, MediaTime media_time,
                     const std::shared_ptr<const CodedRelief>& relief) {
  CodedFrame frame;
  frame.id = id;
  frame.media_time = media_time;
  frame.objects.push_back({1, 0, id, relief, {}, nullptr, {}, {}});
  return frame;
}

/// Calls `publish` with the number of each frame at its time, as long as it plays, for ever.
template <class Publish>
[[noreturn]] void pace(double fps, const Switch& playing, const Publish& publish) {
  const auto begin = std::chrono::steady_clock::now();
  std::uint64_t id = 0;
  for (std::uint64_t turn = 1;; ++turn) {
    std::this_thread::sleep_until(begin + fromSeconds(static_cast<double>(turn) / fps));
    if (playing.on()) publish(++id);
  }
}

MediaTime readSteadyClock() { return MediaTime(SteadyClock().now().time_since_epoch()); }

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// A socket on a port of loopback.
struct Bound {
  int socket = -1;
  std::uint16_t port = 0;
};
Bound bound(int type) {
  Bound bound{::socket(AF_INET, type | SOCK_CLOEXEC, 0)};
  sockaddr_in address = loopback(0);
  socklen_t length = sizeof address;
  auto* const name = reinterpret_cast<sockaddr*>(&address);
  require(
      ::bind(bound.socket, name, length) == 0 && ::getsockname(bound.socket, name, &length) == 0,
      "no port");
  bound.port = ntohs(address.sin_port);
  return bound;
}

std::vector<int> acceptAll(int listener, std::size_t viewers) {
  std::vector<int> sockets;
  sockets.reserve(viewers);
  const int on = 1, buffer_bytes = server::StreamSettings().send_buffer_bytes;
  while (sockets.size() < viewers) {
    const int socket = ::accept(listener, nullptr, nullptr);
    require(socket >= 0, "cannot accept");
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &buffer_bytes, sizeof buffer_bytes);
    sockets.push_back(socket);
  }
  return sockets;
}

}  // namespace

Switch::Switch() {
  void* const shared =
      ::mmap(nullptr, sizeof *on_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  require(shared != MAP_FAILED, "no memory");
  on_ = new (shared) std::atomic<bool>(false);
}

Switch::~Switch() { ::munmap(on_, sizeof *on_); }

ServerProcess::ServerProcess(const Serve& serve) {
  std::array<int, 2> ends{};
  require(::pipe(ends.data()) == 0, "no pipe");
  pid_ = ::fork();
  require(pid_ >= 0, "no process");
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::close(ends[0]);
    try {
      serve([&](std::uint16_t port) { (void)!::write(ends[1], &port, sizeof port); });
    } catch (const std::exception& error) {
      std::fprintf(stderr, "hapticast-viewers: %s\n", error.what());
    }
    ::_exit(1);
  }
  ::close(ends[1]);
  const bool told = ::read(ends[0], &port_, sizeof port_) == sizeof port_;
  ::close(ends[0]);
  require(told, "the server's process has ended");
}

ServerProcess::~ServerProcess() {
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

ServerProcess::Serve broadcaster(const Frames& frames, const Switch& playing) {
  return [frames, &playing](const std::function<void(std::uint16_t)>& tell) {
    spdlog::set_level(spdlog::level::err);  // the crowd itself counts what it does not get
    const SteadyClock clock;
    const LocalMediaClock media(clock);
    asio::io_context io;
    StreamDescription description;
    description.fps = frames.fps;
    server::StreamSettings settings;
    settings.max_clients = server::raiseFileLimit(frames.viewers);
    server::Broadcaster broadcaster(io, clock, media, description, settings);
    server::PageResponder page({"localhost"});
    server::Listener listener(io, {"127.0.0.1", 0}, broadcaster, std::nullopt, &page);
    server::FrameSigner signer;
    server::DatagramSender sender(io, clock, listener.endpoint(), signer.identity());
    broadcaster.introduce(signer.identity());
    broadcaster.enableUdp(sender);
    listener.start();
    const std::jthread network([&io] { io.run(); });
    tell(listener.address().port);
    const auto relief = makeRelief(frames.bytes);
    pace(frames.fps, playing, [&](std::uint64_t id) {
      const MediaTime now = media.now();
      const CodedFrame frame = frameWith(id, now, relief);
      const SharedBytes payload = signer.signMessage(frame);
      broadcaster.publish(server::EncodedFrame{
          0, id, now, payload, std::make_shared<server::LazyKeyFrame>(payload),
          broadcaster.datagramsWanted() ? signer.signDatagrams(frame) : nullptr});
    });
  };
}

ServerProcess::Serve bareLoop(const Frames& frames, const Switch& playing) {
  return [frames, &playing](const std::function<void(std::uint16_t)>& tell) {
    (void)server::raiseFileLimit(frames.viewers);
    const Bound listener = bound(SOCK_STREAM);
    require(::listen(listener.socket, SOMAXCONN) == 0, "cannot listen");
    tell(listener.port);
    const std::vector<int> sockets = acceptAll(listener.socket, frames.viewers);
    const auto relief = makeRelief(frames.bytes);
    pace(frames.fps, playing, [&](std::uint64_t id) {
      const auto bytes = framed(encode(frameWith(id, readSteadyClock(), relief)));
      for (const int socket : sockets) sendAll(socket, bytes);
    });
  };
}

ServerProcess::Serve bareDatagrams(const Frames& frames, const Switch& playing) {
  return [frames, &playing](const std::function<void(std::uint16_t)>& tell) {
    const Bound socket = bound(SOCK_DGRAM);
    tell(socket.port);
    std::vector<sockaddr_in> viewers(frames.viewers);
    for (sockaddr_in& viewer : viewers) {
      char hello = 0;
      socklen_t length = sizeof viewer;
      auto* const name = reinterpret_cast<sockaddr*>(&viewer);
      require(::recvfrom(socket.socket, &hello, 1, 0, name, &length) == 1 &&
                  ::sendto(socket.socket, &hello, 1, 0, name, length) == 1,
              "no viewer");
    }
    server::FrameSigner signer;
    const auto relief = makeRelief(frames.bytes);
    pace(frames.fps, playing, [&](std::uint64_t id) {
      const server::SignedDatagrams bodies =
          signer.signDatagrams(frameWith(id, readSteadyClock(), relief));
      for (const auto& body : *bodies) {
        std::vector<std::uint8_t> bytes(kTokenBytes + body.size());  // GCC 14 warns of insert()
        std::copy(body.begin(), body.end(), bytes.begin() + kTokenBytes);
        for (const sockaddr_in& viewer : viewers) {
          (void)::sendto(socket.socket, bytes.data(), bytes.size(), 0,
                         reinterpret_cast<const sockaddr*>(&viewer), sizeof viewer);
        }
      }
    });
  };
}

ServerProcess::Serve broker(Transport way) {
  return [way](const std::function<void(std::uint16_t)>& tell) {
    (void)server::raiseFileLimit(10'000);  // which the program keeps
    const Bound place = bound(SOCK_STREAM);
    ::close(place.socket);  // nobody else takes its port so soon
    const std::string port = std::to_string(place.port);
    const int file = ::memfd_create("settings", 0);
    const std::string path = "/proc/self/fd/" + std::to_string(file);
    const std::string settings = way == Transport::kMqtt
                                     ? "listener " + port +
                                           " 127.0.0.1\nallow_anonymous true\nuser root\n"
                                           "set_tcp_nodelay true\nlog_type error\n"
                                     : "listen: 127.0.0.1:" + port +
                                           "\nping_interval: \"1h\"\n"
                                           "max_connections: 100000\n";
    require(file >= 0 && ::write(file, settings.data(), settings.size()) > 0, "no settings");
    tell(place.port);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDERR_FILENO);
    if (way == Transport::kMqtt) ::execlp("mosquitto", "mosquitto", "-c", path.c_str(), nullptr);
    if (way == Transport::kNats)
      ::execlp("nats-server", "nats-server", "-c", path.c_str(), nullptr);
    ::_exit(1);
  };
}

ServerProcess::Serve publisher(Transport way, std::uint16_t port, const Frames& frames,
                               const Switch& playing) {
  return [=, &playing](const std::function<void(std::uint16_t)>& tell) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    int socket = findConnected(port);
    for (; socket < 0; socket = findConnected(port)) {
      require(std::chrono::steady_clock::now() < give_up, "no broker (is it installed?)");
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    greet(way, socket, false);
    tell(port);
    const auto relief = makeRelief(frames.bytes);
    pace(frames.fps, playing, [&](std::uint64_t id) {
      sendAll(socket, published(way, encode(frameWith(id, readSteadyClock(), relief))));
    });
  };
}

}  // namespace hapticast::testing
