// SPDX-License-Identifier: MIT
// hapticast-flood: what forged datagrams do to a viewer in contact, against the same flood sent to
// a port of its machine at which nobody listens. Starts server and client by itself, in turns of
// both. Needs the right to raw sockets.
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/cli/options.hpp"
#include "tests/bench/flood/eavesdropper.hpp"
#include "tests/bench/viewers/cpu_time.hpp"
#include "tests/support/process.hpp"
#include "tests/support/program.hpp"

namespace hapticast::testing {
namespace {

const std::map<std::string, Knows> kKnows{
    {"nothing", Knows::kNothing}, {"address", Knows::kAddress}, {"token", Knows::kToken}};
// The hand is in contact by then, and stays there for as long as it takes.
constexpr double kContact_s = 3.0;
constexpr std::uint16_t kPort = 7471;
constexpr const char* kFallback = "taking them over TCP";

struct Settings {
  Knows knows = Knows::kAddress;
  double rate_Hz = 50'000.0;
  double seconds = 5.0;
  std::uint64_t pairs = 5;
};

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Floods a viewer in contact with forged datagrams and says what it felt of them.",
      "hapticast-flood");
  addChoice(*app, "--knows", settings.knows, kKnows,
            "of the stream: nothing, the server's address, token and ids, too (default: address)");
  addNumber(*app, "--rate", settings.rate_Hz, 1.0, 1e6, "HZ",
            "datagrams a second (default: 50000)");
  addNumber(*app, "--seconds", settings.seconds, 1.0, 1000.0, "S", "of each flood (default: 5)");
  addNumber(*app, "--pairs", settings.pairs, std::uint64_t{1}, std::uint64_t{100}, "N",
            "floods at the viewer, each beside one at a closed port (default: 5)");
  return app;
}

struct Tick {
  double t_s = 0.0, penetration_mm = 0.0;
  std::array<double, 3> surface_N{};  ///< before the chain
};

std::vector<Tick> readTicks(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);  // the columns' names
  std::vector<Tick> ticks;
  while (std::getline(in, line)) {
    Tick tick;
    if (std::sscanf(line.c_str(), "%lf,%*f,%*f,%*f,%*f,%*f,%*f,%*f,%lf,%lf,%lf,%*f,%*f,%*f,%lf",
                    &tick.t_s, &tick.surface_N[0], &tick.surface_N[1], &tick.surface_N[2],
                    &tick.penetration_mm) == 5)
      ticks.push_back(tick);
  }
  return ticks;
}

/// For the files of one run; gone with it.
struct Folder {
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string operator/(const char* name) const { return (path / name).string(); }

  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("hapticast-flood-" + std::to_string(::getpid()));
};

// A program that runs out of memory here may end.
// NOLINTNEXTLINE(bugprone-exception-escape)
struct Outcome {
  nlohmann::json summary;
  std::vector<Tick> ticks;
  std::uint64_t sent = 0;
  double network = 0.0;  ///< share of a processor in the flood: of the thread that receives
  double process = 0.0;
  std::optional<double> fallback_s;  ///< from the flood's begin until TCP took over
};

/// The relative RMS of what the surface asks for, against another run of the same script.
double forceError(const Outcome& run, const Outcome& reference) {
  double off = 0.0, all = 0.0;
  const std::size_t ticks = std::min(run.ticks.size(), reference.ticks.size());
  for (std::size_t i = 0; i < ticks; ++i) {
    if (run.ticks[i].t_s < kContact_s) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double should = reference.ticks[i].surface_N[axis];
      off += std::pow(run.ticks[i].surface_N[axis] - should, 2);
      all += should * should;
    }
  }
  return all > 0.0 ? std::sqrt(off / all) : std::nan("");
}

void flood(Eavesdropper& forger, const Settings& settings, bool at_closed_port, Process& client,
           Outcome& out) {
  const SteadyClock clock;
  const LocalTime begin = clock.now(), end = begin + fromSeconds(settings.seconds);
  const ProcessTime before = processTime(client.id());
  LocalTime look = begin;
  for (LocalTime now = begin; now < end; now = clock.now()) {
    forger.flood(settings.knows, at_closed_port, settings.rate_Hz, now);
    if (!out.fallback_s && now >= look) {
      look = now + std::chrono::milliseconds(10);
      if (countOccurrences(kFallback, client.output()) > 0) out.fallback_s = toSeconds(now - begin);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  const CpuUsed cpu = used(before, processTime(client.id()));
  out.network = toSeconds(cpu.network) / settings.seconds;
  out.process = toSeconds(cpu.process) / settings.seconds;
  out.sent = forger.sent();
}

Outcome play(const Settings& settings, bool at_closed_port) {
  const Folder folder;
  const std::string log = folder / "log.csv", sum = folder / "sum.json";
  const std::string hand = folder / "hold.csv";
  std::ofstream(hand) << "0,0,0,25\n1,0,0,25\n1.5,0,0,8\n1000,0,0,8\n";
  const std::string at = "127.0.0.1:" + std::to_string(kPort);
  Eavesdropper forger(kPort);
  Process server(
      {HAPTICAST_SERVER_PROGRAM, "--source", "synthetic:still", "--loop", "--listen", at});
  if (!server.says("streaming", std::chrono::seconds(30)))
    throw std::runtime_error("no server: " + server.output());
  Process client({HAPTICAST_CLIENT_PROGRAM, at, "--device", "virtual", "--hand", hand, "--seconds",
                  std::to_string(kContact_s + settings.seconds + 2.0), "--log", log, "--summary",
                  sum});
  const bool seen = waitUntil(std::chrono::seconds(10), [&] { return forger.listen(); });
  if (!seen) throw std::runtime_error("no datagram was seen: " + client.output());
  std::this_thread::sleep_for(std::chrono::duration<double>(kContact_s));
  Outcome out;
  flood(forger, settings, at_closed_port, client, out);
  if (client.wait(std::chrono::seconds(20)) != 0) throw std::runtime_error(client.output());
  out.summary = nlohmann::json::parse(std::ifstream(sum));
  out.ticks = readTicks(log);
  return out;
}

void tell(const char* where, const Outcome& out, double error) {
  const auto& datagrams = out.summary["datagrams"];
  const std::string fallback =
      out.fallback_s ? "TCP took over after " + std::to_string(*out.fallback_s).substr(0, 5) + " s"
                     : "went on by " + out.summary["delivery"]["way"].get<std::string>();
  std::printf(
      "%-11s %7llu sent; late ticks %4d of %d; force off by %.2g; step excess %g N; network thread "
      "%4.1f %%, process %4.1f %%; foreign %s, forged %s, over budget %s; frames lost %s; %s\n",
      where, static_cast<unsigned long long>(out.sent), out.summary["late_ticks"].get<int>(),
      out.summary["ticks"].get<int>(), error, out.summary["step_excess_max_N"].get<double>(),
      100.0 * out.network, 100.0 * out.process, datagrams["foreign"].dump().c_str(),
      datagrams["forged"].dump().c_str(), datagrams["over_budget"].dump().c_str(),
      out.summary["frames"]["lost"].dump().c_str(), fallback.c_str());
  std::fflush(stdout);
}

void run(const Settings& settings) {
  std::optional<Outcome> reference;
  for (std::uint64_t i = 0; i < settings.pairs; ++i) {
    const Outcome closed = play(settings, true);
    if (!reference) reference = closed;
    tell("closed port", closed, forceError(closed, *reference));
    const Outcome open = play(settings, false);
    tell("viewer", open, forceError(open, *reference));
  }
}

}  // namespace
}  // namespace hapticast::testing

int main(int argc, char** argv) {
  using namespace hapticast::testing;
  return program<Settings>("hapticast-flood", commandLine, run, argc, argv);
}
