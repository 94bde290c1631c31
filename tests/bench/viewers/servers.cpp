// SPDX-License-Identifier: MIT
#include "tests/bench/viewers/servers.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/stream/datagram_sender.hpp"
#include "server/stream/file_limit.hpp"
#include "server/stream/listener.hpp"
#include "tests/support/framed.hpp"

namespace hapticast::testing {

namespace {

/// A relief of about so many bytes on the wire; nobody here decodes it.
std::shared_ptr<const CodedRelief> reliefOf(std::size_t bytes) {
  CodedRelief relief{{0, 0, 640, 480}, {}, 0};
  for (std::size_t left = bytes; left > 0; left -= relief.slices.back().size())
    relief.slices.emplace_back(std::min(left, kMostSliceBytes));
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

/// Calls `publish` with the number of each frame at its time, for ever.
template <class Publish>
[[noreturn]] void pace(double fps, const Publish& publish) {
  const auto begin = std::chrono::steady_clock::now();
  for (std::uint64_t id = 1;; ++id) {
    std::this_thread::sleep_until(begin + fromSeconds(static_cast<double>(id) / fps));
    publish(id);
  }
}

void require(bool done, const char* what) {
  if (!done) throw std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

/// Sends all of it; waits only where the peer's buffers are full.
void sendAll(int socket, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else {
      require(errno == EAGAIN || errno == EINTR, "cannot send");
      pollfd writable{socket, POLLOUT, 0};
      ::poll(&writable, 1, -1);
    }
  }
}

}  // namespace

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

ServerProcess::Serve broadcaster(const Frames& frames) {
  return [frames](const std::function<void(std::uint16_t)>& tell) {
    spdlog::set_level(spdlog::level::err);  // the crowd itself counts what it does not get
    const SteadyClock clock;
    const LocalMediaClock media(clock);
    asio::io_context io;
    StreamDescription description;
    description.fps = frames.fps;
    server::StreamSettings settings;
    settings.max_clients = server::raiseFileLimit(frames.viewers);
    server::Broadcaster broadcaster(io, clock, media, description, settings);
    server::Listener listener(io, {"127.0.0.1", 0}, broadcaster);
    server::DatagramSigner signer;
    server::DatagramSender sender(io, clock, listener.endpoint(), signer);
    broadcaster.carryDatagrams(sender);
    listener.start();
    const std::jthread network([&io] { io.run(); });
    tell(listener.address().port);
    const auto relief = reliefOf(frames.bytes);
    pace(frames.fps, [&](std::uint64_t id) {
      const MediaTime now = media.now();
      const CodedFrame frame = frameWith(id, now, relief);
      const SharedBytes payload = encodeShared(frame);
      broadcaster.publish(
          server::EncodedFrame{0, id, now, payload, std::make_shared<server::WholeFrame>(payload),
                               broadcaster.datagramsWanted() ? signer.sign(frame) : nullptr});
    });
  };
}

ServerProcess::Serve bareLoop(const Frames& frames) {
  return [frames](const std::function<void(std::uint16_t)>& tell) {
    (void)server::raiseFileLimit(frames.viewers);
    const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    auto* const name = reinterpret_cast<sockaddr*>(&address);
    require(::bind(listener, name, length) == 0 && ::listen(listener, SOMAXCONN) == 0 &&
                ::getsockname(listener, name, &length) == 0,
            "cannot listen");
    tell(ntohs(address.sin_port));
    std::vector<int> sockets;
    sockets.reserve(frames.viewers);
    const int on = 1, buffer_bytes = server::StreamSettings().send_buffer_bytes;
    while (sockets.size() < frames.viewers) {
      const int socket = ::accept(listener, nullptr, nullptr);
      require(socket >= 0, "cannot accept");
      ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &buffer_bytes, sizeof buffer_bytes);
      sockets.push_back(socket);
    }
    const SteadyClock clock;
    const auto relief = reliefOf(frames.bytes);
    pace(frames.fps, [&](std::uint64_t id) {
      const MediaTime now(clock.now().time_since_epoch());
      const auto bytes = framed(encode(frameWith(id, now, relief)));
      for (const int socket : sockets) sendAll(socket, bytes);
    });
  };
}

}  // namespace hapticast::testing
