// SPDX-License-Identifier: MIT
#include "tests/bench/viewers/contest.hpp"

#include <netdb.h>

#include <algorithm>
#include <stdexcept>

namespace hapticast::testing {

namespace {

constexpr auto kStragglers = std::chrono::milliseconds(500);

sockaddr_in resolve(const Endpoint& endpoint) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(endpoint.host.c_str(), std::to_string(endpoint.port).c_str(), &hints, &found) !=
      0)
    throw std::runtime_error(endpoint.host + ": there is no IPv4 host of this name");
  const auto address = *reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  ::freeaddrinfo(found);
  return address;
}

ServerProcess::Serve serverOf(Contestant who, const Frames& frames, const Switch& playing) {
  switch (who) {
    case Contestant::kTcp:
    case Contestant::kUdp:
    case Contestant::kWebSocket:
      return broadcaster(frames, playing);
    case Contestant::kBareTcp:
      return bareLoop(frames, playing);
    case Contestant::kBareUdp:
      return bareDatagrams(frames, playing);
    case Contestant::kMosquitto:
    case Contestant::kNats:
      break;
  }
  return broker(wayOf(who));
}

}  // namespace

Transport wayOf(Contestant who) {
  switch (who) {
    case Contestant::kTcp:
      return Transport::kTcp;
    case Contestant::kUdp:
      return Transport::kUdp;
    case Contestant::kWebSocket:
      return Transport::kWebSocket;
    case Contestant::kBareTcp:
      return Transport::kPlainTcp;
    case Contestant::kBareUdp:
      return Transport::kPlainUdp;
    case Contestant::kMosquitto:
      return Transport::kMqtt;
    case Contestant::kNats:
      return Transport::kNats;
  }
  return Transport::kTcp;
}

Contender::Contender(Contestant who, const Frames& frames) : frames_(frames) {
  const Transport way = wayOf(who);
  processes_.push_back(std::make_unique<ServerProcess>(serverOf(who, frames_, playing_)));
  pid_ = processes_.front()->id();
  const std::uint16_t port = processes_.front()->port();
  if (way == Transport::kMqtt || way == Transport::kNats) {
    processes_.push_back(std::make_unique<ServerProcess>(publisher(way, port, frames_, playing_)));
  }
  crowd_ = std::make_unique<Crowd>(resolve({"127.0.0.1", port}), frames_.viewers, way);
}

Contender::Contender(Transport way, const Endpoint& server, std::optional<pid_t> pid,
                     const Frames& frames)
    : frames_(frames),
      runs_already_(true),
      pid_(pid),
      crowd_(std::make_unique<Crowd>(resolve(server), frames_.viewers, way)) {}

void Contender::join() {
  playing_.set(true);
  crowd_->join();
  playing_.set(false);
}

void Contender::play(Duration time, std::span<Crowd* const> all) {
  // What the frames before have left is read before the counting begins.
  const Duration two_frames = fromSeconds(2.0 / frames_.fps);
  receiveFor(all, two_frames);
  crowd_->begin();
  const ProcessTime before = processTime(pid_.value_or(-1));
  playing_.set(true);
  receiveFor(all, time);
  playing_.set(false);
  std::uint64_t last = crowd_->newest();
  if (!runs_already_) {  // all that was sent counts, and what it took to send it
    receiveFor(all, two_frames);
    receiveFor(all, kStragglers, [this] { return crowd_->complete(); });
    last = crowd_->newest();
  }
  cpu_ += used(before, processTime(pid_.value_or(-1)));
  if (runs_already_) receiveFor(all, kStragglers);
  crowd_->end(last);
  played_ += time;
}

double Contender::each_us(Duration cpu) const {
  const std::uint64_t delivered = crowd_->passage().delivered;
  return 1e6 * toSeconds(cpu) / static_cast<double>(std::max<std::uint64_t>(delivered, 1));
}

}  // namespace hapticast::testing
