// SPDX-License-Identifier: MIT
// hapticast-link: a bad network to try things by hand. Stands between clients and a server on TCP
// and UDP, and says once a second what became of the packets.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <iostream>
#include <sstream>

#include "common/cli/options.hpp"
#include "tests/support/lossy_link.hpp"
#include "tests/support/program.hpp"

namespace hapticast::testing {
namespace {

const std::map<std::string, Jitter> kDistributions{{"uniform", Jitter::kUniform},
                                                   {"normal", Jitter::kNormal},
                                                   {"exponential", Jitter::kExponential}};

struct Settings {
  Endpoint listen{"127.0.0.1", 7448};
  Endpoint server{"127.0.0.1", kDefaultPort};
  LinkProfile profile;  ///< but for these three
  double delay_ms = 0.0;
  double jitter_ms = 0.0;
  double rate_Mbit_s = 0.0;
  double cut_after_s = 0.0;
  bool quiet = false;
};

void addFaults(CLI::App& app, Settings& settings) {
  LinkProfile& profile = settings.profile;
  addNumber(app, "--delay", settings.delay_ms, 0.0, 60e3, "MS", "how long packets are under way");
  addNumber(app, "--jitter", settings.jitter_ms, 0.0, 60e3, "MS", "how much that varies");
  addChoice(app, "--distribution", profile.distribution, kDistributions,
            "uniform: up to --jitter on top; normal: --jitter is the standard deviation; "
            "exponential: --jitter is the mean on top (default: uniform)");
  addNumber(app, "--loss", profile.loss, 0.0, 1.0, "P",
            "share of packets that are lost; TCP only waits for them, 200 ms or a round trip");
  addNumber(app, "--burst", profile.burst, 1.0, 1000.0, "N",
            "mean length of a run of lost packets (default: 1, each by itself)");
  addNumber(app, "--duplicate", profile.duplicate, 0.0, 1.0, "P",
            "share of datagrams that come twice");
  addNumber(app, "--reorder", profile.reorder, 0.0, 1.0, "P",
            "share of datagrams that are held back for up to 40 ms");
  addNumber(app, "--rate", settings.rate_Mbit_s, 0.0, 1e5, "MBIT/S",
            "what goes through each way (default: 0, no limit)");
  addNumber(
      app, "--queue", profile.queue_bytes, std::size_t{1500}, std::size_t{1} << 30U, "BYTES",
      "that wait for the rate (default: 131072); TCP has about as many again, at least 65536");
  addNumber(app, "--largest", profile.largest_bytes, std::uint64_t{0}, std::uint64_t{65535},
            "BYTES", "larger datagrams vanish; 0: all do (default: 65535)");
  addNumber(app, "--seed", profile.seed, std::uint64_t{0}, std::uint64_t{4294967295}, "N",
            "the same one loses the same packets of each connection (default: 1)");
}

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Relays TCP and UDP to a server through a bad network, the same both ways.",
      "hapticast-link");
  addEndpoint(*app, "--listen", settings.listen, 0, "[ADDR:]PORT",
              "where clients connect (default: 127.0.0.1:7448)");
  addEndpoint(*app, "--server", settings.server, 1, "HOST:PORT",
              "the server (default: 127.0.0.1:7447)");
  addFaults(*app, settings);
  addNumber(*app, "--cut-after", settings.cut_after_s, 0.0, 1e6, "S",
            "resets all connections once after so long (default: 0, never)");
  app->add_flag("--quiet", settings.quiet, "the figures at the end only");
  app->set_config("--config", "", "FILE");  // errors have the form of the other programs
  return app;
}

/// The events since `before`.
std::string told(const LinkCounts& now, const LinkCounts& before) {
  const std::uint64_t packets = now.packets - before.packets;
  std::ostringstream line;
  line << packets << " packets, " << (now.bytes - before.bytes) / 1000 << " kB";
  const auto add = [&](std::uint64_t LinkCounts::*count, const char* word) {
    if (now.*count > before.*count) line << ", " << now.*count - before.*count << " " << word;
  };
  add(&LinkCounts::lost, "lost");
  add(&LinkCounts::too_large, "too large");
  add(&LinkCounts::overflowed, "too many");
  add(&LinkCounts::duplicated, "doubled");
  add(&LinkCounts::reordered, "held back");
  if (now.deliveries > before.deliveries) {
    const auto deliveries = static_cast<double>(now.deliveries - before.deliveries);
    const double delay_ms = 1e3 * toSeconds(now.delay - before.delay) / deliveries;
    line << ", " << std::round(100.0 * delay_ms) / 100.0 << " ms under way";
  }
  return line.str();
}

asio::ip::tcp::endpoint resolve(asio::io_context& io, const Endpoint& of) {
  return *asio::ip::tcp::resolver(io).resolve(of.host, std::to_string(of.port)).begin();
}

void run(const Settings& settings) {
  LinkProfile profile = settings.profile;
  profile.delay = fromSeconds(1e-3 * settings.delay_ms);
  profile.jitter = fromSeconds(1e-3 * settings.jitter_ms);
  profile.rate_bits_s = 1e6 * settings.rate_Mbit_s;
  asio::io_context io;
  LossyLink link(io, resolve(io, settings.listen), resolve(io, settings.server), profile, profile);
  std::cout << "relaying " << toString(Endpoint{settings.listen.host, link.port()}) << " to "
            << toString(settings.server) << "; Ctrl-C ends it" << std::endl;
  asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](const boost::system::error_code&, int) { io.stop(); });
  asio::steady_timer cut(io, fromSeconds(settings.cut_after_s));
  if (settings.cut_after_s > 0.0)
    cut.async_wait([&](const boost::system::error_code&) { link.cut(); });
  LinkCounts up, down;
  asio::steady_timer second(io);
  const auto tell = [&] {
    std::cout << "up: " << told(link.up().counts, up)
              << "; down: " << told(link.down().counts, down) << std::endl;
    up = link.up().counts;
    down = link.down().counts;
  };
  std::function<void()> everySecond = [&] {
    second.expires_after(std::chrono::seconds(1));
    second.async_wait([&](const boost::system::error_code&) {
      if (!(link.up().counts == up && link.down().counts == down)) tell();
      everySecond();
    });
  };
  if (!settings.quiet) everySecond();
  io.run();
  up = down = {};
  std::cout << "in all: ";
  tell();
}

}  // namespace
}  // namespace hapticast::testing

int main(int argc, char** argv) {
  using namespace hapticast::testing;
  return program<Settings>("hapticast-link", commandLine, run, argc, argv);
}
