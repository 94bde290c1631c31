// SPDX-License-Identifier: MIT
#include <array>
#include <cstdio>

#include "tests/bench/viewers/trials.hpp"

namespace hapticast::testing {

void besideBrowsers(Contestant who, const Frames& frames, std::size_t browsers, Duration time) {
  Frames places = frames;
  places.viewers += browsers;
  Switch playing;
  const ServerProcess server(broadcaster(places, playing));
  const Endpoint address{"127.0.0.1", server.port()};
  Contender native(wayOf(who), address, server.id(), frames);
  playing.set(true);
  native.join();
  const auto play = [&](std::span<Crowd* const> crowds, std::size_t present) {
    native.play(time, crowds);
    const Passage passage = native.crowd().takePassage();
    const auto ms = [&](double q) {
      return 1e-6 * static_cast<double>(passage.latency.quantile_ns(q));
    };
    std::printf(
        "%zu by WebSocket: the others got %llu of %llu frames (%llu lost); latency p50 "
        "%.2f, p99 %.2f ms\n",
        present, static_cast<unsigned long long>(passage.delivered),
        static_cast<unsigned long long>(passage.expected),
        static_cast<unsigned long long>(passage.expected - passage.delivered), ms(0.5), ms(0.99));
    std::fflush(stdout);
  };
  play(std::array<Crowd*, 1>{&native.crowd()}, 0);
  Frames theirs = frames;
  theirs.viewers = browsers;
  Contender web(Transport::kWebSocket, address, server.id(), theirs);
  web.join();
  web.crowd().begin();
  play(std::array<Crowd*, 2>{&native.crowd(), &web.crowd()}, browsers);
  web.crowd().end(web.crowd().newest());
  const Passage passage = web.crowd().passage();
  std::printf("those by WebSocket got %llu of %llu frames\n",
              static_cast<unsigned long long>(passage.delivered),
              static_cast<unsigned long long>(passage.expected));
}

}  // namespace hapticast::testing
