// SPDX-License-Identifier: MIT
// hapticast-viewers: how many viewers a server feeds, how late, and what each frame costs it. The
// processor's time is a thread's own, so that ratios hold on a busy machine too; latencies do not.
#include <netdb.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "common/cli/options.hpp"
#include "server/stream/file_limit.hpp"
#include "tests/bench/viewers/cpu_time.hpp"
#include "tests/bench/viewers/crowd.hpp"
#include "tests/bench/viewers/servers.hpp"
#include "tests/support/program.hpp"

namespace hapticast::testing {
namespace {

const std::map<std::string, Way> kTransports{{"tcp", Way::kTcp}, {"udp", Way::kUdp}};

struct Settings {
  Endpoint server{"127.0.0.1", kDefaultPort};
  Frames frames;
  double seconds = 5.0;
  std::uint64_t rounds = 3;
  std::uint64_t server_pid = 0;
  Way way = Way::kTcp;
  bool broadcast = false;
  bool bare = false;
};

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Plays many viewers of a server and says what they got and what it cost the server.",
      "hapticast-viewers");
  addEndpoint(*app, "--server", settings.server, 1, "HOST:PORT",
              "the server (default: 127.0.0.1:7447)");
  addNumber(*app, "--server-pid", settings.server_pid, std::uint64_t{1}, std::uint64_t{1U << 22U},
            "PID", "its process on this machine: measures what it computes");
  app->add_flag(
      "--broadcast", settings.broadcast,
      "instead: starts the server's own broadcaster, fed with frames of --bytes at --fps");
  addNumber(*app, "--bytes", settings.frames.bytes, std::uint64_t{64}, std::uint64_t{8U << 20U},
            "N", "of each frame's relief (default: 20000)");
  addNumber(*app, "--fps", settings.frames.fps, 0.1, 1000.0, "F", "frames a second (default: 30)");
  addNumber(*app, "--viewers", settings.frames.viewers, std::uint64_t{1}, std::uint64_t{100000},
            "N", "how many (default: 1000)");
  addNumber(*app, "--seconds", settings.seconds, 0.1, 1e5, "S", "of each round (default: 5)");
  addNumber(*app, "--rounds", settings.rounds, std::uint64_t{1}, std::uint64_t{1000}, "N",
            "how often, for medians (default: 3)");
  addChoice(*app, "--transport", settings.way, kTransports, "how frames come (default: tcp)");
  app->add_flag("--bare", settings.bare,
                "beside each round frames as large from a bare loop around send() by TCP, for the "
                "ratio");
  app->set_config("--config", "", "FILE");
  return app;
}

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

struct Round {
  Passage passage;
  double network_us = 0.0;  ///< of the processor, for each frame that a viewer got
  double process_us = 0.0;
};

Round play(const Endpoint& server, std::optional<pid_t> pid, Way way, const Settings& settings) {
  Crowd crowd(resolve(server), settings.frames.viewers, way);
  crowd.join();
  ProcessTime before, after;
  Round round;
  round.passage = crowd.run(
      fromSeconds(settings.seconds), [&] { before = processTime(pid.value_or(-1)); },
      [&] { after = processTime(pid.value_or(-1)); });
  const CpuUsed cpu = used(before, after);
  const auto each = static_cast<double>(std::max<std::uint64_t>(round.passage.delivered, 1));
  round.network_us = 1e6 * toSeconds(cpu.network) / each;
  round.process_us = 1e6 * toSeconds(cpu.process) / each;
  return round;
}

void tell(const char* who, const Round& round, std::size_t viewers) {
  const Passage& passage = round.passage;
  const double time_s = toSeconds(passage.time);
  const auto ms = [](const Histogram& histogram, double q) {
    return 1e-6 * static_cast<double>(histogram.quantile_ns(q));
  };
  std::printf("%-10s %zu viewers: got %llu of %llu frames (%.1f a second each, %.0f MB/s)", who,
              viewers, static_cast<unsigned long long>(passage.delivered),
              static_cast<unsigned long long>(passage.expected),
              static_cast<double>(passage.delivered) / static_cast<double>(viewers) / time_s,
              1e-6 * static_cast<double>(passage.bytes) / time_s);
  std::printf("; latency p50 %.1f, p99 %.1f ms; behind the first p50 %.1f, p99 %.1f ms",
              ms(passage.latency, 0.5), ms(passage.latency, 0.99), ms(passage.spread, 0.5),
              ms(passage.spread, 0.99));
  if (round.process_us > 0.0)
    std::printf("; CPU %.2f us a frame (whole process %.2f)", round.network_us, round.process_us);
  std::printf("\n");
  std::fflush(stdout);
}

Round playServer(const Settings& settings) {
  if (settings.broadcast) {
    const ServerProcess server(broadcaster(settings.frames));
    return play({"127.0.0.1", server.port()}, server.id(), settings.way, settings);
  }
  const auto pid = static_cast<pid_t>(settings.server_pid);
  return play(settings.server, pid > 0 ? std::optional(pid) : std::nullopt, settings.way, settings);
}

/// With frames as large and as often as they came from the server.
Round playBare(Settings settings, const Passage& as) {
  settings.frames.bytes = as.delivered > 0 ? as.bytes / as.delivered : settings.frames.bytes;
  settings.frames.fps = static_cast<double>(as.frames) / toSeconds(as.time);
  const ServerProcess server(bareLoop(settings.frames));
  return play({"127.0.0.1", server.port()}, server.id(), Way::kPlain, settings);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void run(const Settings& settings) {
  const std::size_t viewers = settings.frames.viewers;
  if (server::raiseFileLimit(2 * viewers) < 2 * viewers)
    throw std::runtime_error("this system allows fewer open files than viewers");
  std::vector<double> server_us, bare_us, ratios;
  for (std::uint64_t i = 0; i < settings.rounds; ++i) {
    const Round served = playServer(settings);
    tell("hapticast", served, viewers);
    server_us.push_back(served.network_us);
    if (!settings.bare) continue;
    const Round bare = playBare(settings, served.passage);
    tell("bare send", bare, viewers);
    bare_us.push_back(bare.network_us);
    ratios.push_back(served.network_us / bare.network_us);
  }
  if (!ratios.empty()) {
    std::printf("medians of %zu rounds: %.2f us a frame, bare send() %.2f us, ratio %.2f\n",
                ratios.size(), median(server_us), median(bare_us), median(ratios));
  }
}

}  // namespace
}  // namespace hapticast::testing

int main(int argc, char** argv) {
  using namespace hapticast::testing;
  return program<Settings>("hapticast-viewers", commandLine, run, argc, argv);
}
