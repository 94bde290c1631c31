// SPDX-License-Identifier: MIT
// hapticast-viewers: how many viewers a server feeds, how late, and what each frame costs it. The
// processor's time is a thread's own, so that ratios hold on a busy machine too; latencies do not.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>

#include "common/cli/options.hpp"
#include "server/stream/listener.hpp"
#include "tests/bench/viewers/contest.hpp"
#include "tests/bench/viewers/trials.hpp"
#include "tests/support/program.hpp"

namespace hapticast::testing {
namespace {

const std::map<std::string, Contestant> kContestants{{"tcp", Contestant::kTcp},
                                                     {"udp", Contestant::kUdp},
                                                     {"websocket", Contestant::kWebSocket},
                                                     {"bare", Contestant::kBareTcp},
                                                     {"bare-udp", Contestant::kBareUdp},
                                                     {"mosquitto", Contestant::kMosquitto},
                                                     {"nats", Contestant::kNats}};
const std::map<std::string, Contestant> kTransports{
    {"tcp", Contestant::kTcp}, {"udp", Contestant::kUdp}, {"websocket", Contestant::kWebSocket}};
constexpr Duration kTurn = std::chrono::seconds(1);

struct Settings {
  Endpoint server{"127.0.0.1", kDefaultPort};
  Frames frames;
  double seconds = 5.0;
  std::uint64_t rounds = 3;
  std::uint64_t server_pid = 0;
  std::string transport = "tcp";
  bool broadcast = false;
  bool churn = false;
  std::uint64_t stalled = 0;
  std::uint64_t browsers = 0;
  std::vector<std::string> beside;
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
  app->add_option("--transport", settings.transport, "how frames come (default: tcp)")
      ->check(CLI::IsMember(kTransports))
      ->type_name("tcp|udp|websocket");
  app->add_option(
         "--beside", settings.beside,
         "after --broadcast: others that play the same frames in the same rounds, in turns "
         "of a second, each to as many viewers: bare (a loop around send()), bare-udp (one "
         "around sendto()), mosquitto, nats (where they are installed), tcp, udp or "
         "websocket")
      ->check(CLI::IsMember(kContestants))
      ->delimiter(',')
      ->type_name("NAME,...");
  app->add_flag("--churn", settings.churn,
                "instead: --viewers come and go at random for --seconds, and all that they get is "
                "compared");
  addNumber(*app, "--stalled", settings.stalled, std::uint64_t{1}, std::uint64_t{100000}, "N",
            "instead: turns without and with N viewers that read nothing, for --seconds");
  addNumber(*app, "--browsers", settings.browsers, std::uint64_t{1}, std::uint64_t{100000}, "N",
            "instead: turns of --seconds without and with N viewers by WebSocket, --rounds times");
  app->set_config("--config", "", "FILE");
  return app;
}

void tell(const std::string& who, const Contender& contender, std::size_t viewers) {
  const Passage& passage = contender.crowd().passage();
  const double time_s = toSeconds(contender.played());
  const auto ms = [](const Histogram& histogram, double q) {
    return 1e-6 * static_cast<double>(histogram.quantile_ns(q));
  };
  std::printf("%-10s %zu viewers: got %llu of %llu frames (%.1f a second each, %.0f MB/s)",
              who.c_str(), viewers, static_cast<unsigned long long>(passage.delivered),
              static_cast<unsigned long long>(passage.expected),
              static_cast<double>(passage.delivered) / static_cast<double>(viewers) / time_s,
              1e-6 * static_cast<double>(passage.bytes) / time_s);
  std::printf("; latency p50 %.1f, p99 %.1f ms; behind the first p50 %.1f, p99 %.1f ms",
              ms(passage.latency, 0.5), ms(passage.latency, 0.99), ms(passage.spread, 0.5),
              ms(passage.spread, 0.99));
  if (contender.process_us() > 0.0) {
    std::printf("; CPU %.2f us a frame (whole process %.2f)", contender.network_us(),
                contender.process_us());
  }
  std::printf("\n");
  std::fflush(stdout);
}

using Contest = std::vector<std::pair<std::string, std::unique_ptr<Contender>>>;

/// The server itself is the first.
Contest contest(const Settings& settings) {
  Contest contest;
  contest.reserve(1 + settings.beside.size());
  const auto add = [&](const std::string& name) {
    contest.emplace_back(name, std::make_unique<Contender>(kContestants.at(name), settings.frames));
  };
  if (settings.broadcast) {
    add(settings.transport);
    for (const std::string& other : settings.beside) add(other);
  } else {
    const auto pid = static_cast<pid_t>(settings.server_pid);
    contest.emplace_back(
        settings.transport,
        std::make_unique<Contender>(wayOf(kContestants.at(settings.transport)), settings.server,
                                    pid > 0 ? std::optional(pid) : std::nullopt, settings.frames));
  }
  return contest;
}

/// Plays a round; of each contender the processor's time for a frame, in us.
std::vector<double> playRound(const Settings& settings) {
  const Contest all = contest(settings);
  std::vector<Crowd*> crowds;
  crowds.reserve(all.size());
  // Who has joined is left alone meanwhile: the server itself, which minds that, comes last.
  for (auto each = all.rbegin(); each != all.rend(); ++each) {
    each->second->join();
    crowds.push_back(&each->second->crowd());
  }
  const Duration time = fromSeconds(settings.seconds);
  for (Duration played{0}; played < time; played += kTurn) {
    for (const auto& [name, contender] : all)
      contender->play(std::min(kTurn, time - played), crowds);
  }
  std::vector<double> each_us;
  each_us.reserve(all.size());
  for (const auto& [name, contender] : all) {
    tell(name, *contender, settings.frames.viewers);
    each_us.push_back(settings.broadcast ? contender->process_us() : contender->network_us());
  }
  return each_us;
}

std::string spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.2f [%.2f-%.2f]", values[values.size() / 2],
                values.front(), values.back());
  return text.data();
}

void run(const Settings& settings) {
  if (!settings.broadcast && !settings.beside.empty())
    throw std::runtime_error("--beside needs --broadcast");
  const std::size_t files =
      2 * (settings.frames.viewers * (1 + settings.beside.size()) + settings.browsers);
  if (server::raiseFileLimit(files) < files)
    throw std::runtime_error("this system allows fewer open files than viewers");
  const Contestant who = kContestants.at(settings.transport);
  const Duration time = fromSeconds(settings.seconds);
  if (settings.churn) return churn(who, settings.frames, time);
  if (settings.stalled > 0) return stall(who, settings.frames, settings.stalled, time);
  for (std::uint64_t i = 0; settings.browsers > 0 && i < settings.rounds; ++i)
    besideBrowsers(who, settings.frames, settings.browsers, time);
  if (settings.browsers > 0) return;
  std::vector<std::vector<double>> rounds;
  rounds.reserve(settings.rounds);
  for (std::uint64_t i = 0; i < settings.rounds; ++i) rounds.push_back(playRound(settings));
  for (std::size_t i = 0; i <= settings.beside.size(); ++i) {
    std::vector<double> us, ratios;
    for (const auto& round : rounds) {
      us.push_back(round[i]);
      ratios.push_back(round[0] / round[i]);
    }
    const std::string& name = i == 0 ? settings.transport : settings.beside[i - 1];
    std::printf("%-10s median [least-most] of %zu rounds: %s us a frame", name.c_str(),
                rounds.size(), spread(us).c_str());
    if (i > 0)
      std::printf("; %s costs %s of that", settings.transport.c_str(), spread(ratios).c_str());
    std::printf("\n");
  }
}

}  // namespace
}  // namespace hapticast::testing

int main(int argc, char** argv) {
  using namespace hapticast::testing;
  return program<Settings>("hapticast-viewers", commandLine, run, argc, argv);
}
