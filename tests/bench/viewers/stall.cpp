// SPDX-License-Identifier: MIT
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>

#include "tests/bench/viewers/trials.hpp"
#include "tests/support/framed.hpp"

namespace hapticast::testing {

namespace {

constexpr auto kStalledTurn = std::chrono::seconds(4);  // after five the server closes who stalls

/// Memory of the system for TCP, including that of the readers.
double tcpBytes() {
  std::ifstream file("/proc/net/sockstat");
  std::string word;
  double pages = 0.0;
  while (file >> word && word != "TCP:") {
  }
  while (file >> word && word != "mem") {
  }
  file >> pages;
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

class Stalled {
 public:
  Stalled(std::uint16_t port, std::size_t count) {
    const auto hello = framed(encode(Hello{kProtocolVersion, "stalled", false, true}));
    sockets_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      sockets_.push_back(findConnected(port));
      sendAll(sockets_.back(), hello);
    }
  }
  ~Stalled() {
    for (const int socket : sockets_) ::close(socket);
  }
  Stalled(const Stalled&) = delete;
  Stalled& operator=(const Stalled&) = delete;

 private:
  std::vector<int> sockets_;
};

}  // namespace

void stall(Contestant who, const Frames& frames, std::size_t stalled, Duration time) {
  Frames places = frames;
  places.viewers += stalled;
  Switch playing;
  const ServerProcess server(broadcaster(places, playing));
  Contender contender(wayOf(who), {"127.0.0.1", server.port()}, server.id(), frames);
  playing.set(true);
  contender.join();
  const std::array<Crowd*, 1> crowds{&contender.crowd()};
  std::array<std::vector<double>, 2> p99_ms, memory_bytes;
  for (Duration played{0}; played < time; played += 2 * kStalledTurn) {
    for (const std::size_t count : {std::size_t{0}, stalled}) {
      const Stalled these(server.port(), count);
      contender.play(kStalledTurn, crowds);
      const Passage passage = contender.crowd().takePassage();
      const std::size_t kind = count > 0 ? 1 : 0;
      p99_ms[kind].push_back(1e-6 * static_cast<double>(passage.latency.quantile_ns(0.99)));
      memory_bytes[kind].push_back(residentBytes(server.id()) + tcpBytes());
      std::printf(
          "%zu stalled: the others got %llu of %llu frames; latency p50 %.2f, p99 %.2f ms\n", count,
          static_cast<unsigned long long>(passage.delivered),
          static_cast<unsigned long long>(passage.expected),
          1e-6 * static_cast<double>(passage.latency.quantile_ns(0.5)), p99_ms[kind].back());
      std::fflush(stdout);
    }
  }
  for (auto* const values : {&p99_ms[0], &p99_ms[1], &memory_bytes[0], &memory_bytes[1]})
    std::sort(values->begin(), values->end());
  const auto middle = [](const std::vector<double>& values) { return values[values.size() / 2]; };
  std::printf(
      "medians: p99 %.2f ms without, %.2f ms with %zu stalled; %.2f MB for each of these\n",
      middle(p99_ms[0]), middle(p99_ms[1]), stalled,
      1e-6 * (middle(memory_bytes[1]) - middle(memory_bytes[0])) / static_cast<double>(stalled));
}

}  // namespace hapticast::testing
