// SPDX-License-Identifier: MIT
// Both programs when others come, die, hang and come back.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/integration/frame_counter.hpp"
#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

// Under a sanitizer twenty real-time loops would starve everything else.
constexpr std::size_t kClients = kFullSpeed ? 20 : 5;
// A queue that grew would hold far more after some 250 frames of about 20 kB.
constexpr long kGrowth_kB = 16'384;
constexpr double kPushed_N = 0.2;

/// The file that a client wrote with --summary; an empty object where it is none.
nlohmann::json summaryIn(const std::string& file) {
  std::ifstream in(file);
  auto summary = nlohmann::json::parse(in, nullptr, /*allow_exceptions=*/false);
  return summary.is_object() ? summary : nlohmann::json::object();
}

double now_s() { return toSeconds(SteadyClock().now()); }

/// Whether anyone listens on this port of IPv4.
bool listening(std::uint16_t port) {
  std::ifstream table("/proc/net/tcp");
  std::array<char, 8> wanted{};
  std::snprintf(wanted.data(), wanted.size(), ":%04X", port);
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    std::string slot;
    std::string local;
    std::string remote;
    std::string state;
    words >> slot >> local >> remote >> state;
    if (local.ends_with(wanted.data()) && state == "0A") return true;
  }
  return false;
}

class ProgramsLifeTest : public ProgramsTest {
 protected:
  /// A still scene long enough that no wrap of it disturbs a touch.
  [[nodiscard]] std::string stillClip(int frames = 300) const {
    std::string clip = makeClip("still", 1);
    for (const char* part : {"rgb", "depth", "mask"}) {
      const std::string folder = clip + "/" + part + "/";
      for (int i = 101; i < 100 + frames; ++i)
        std::filesystem::create_hard_link(folder + "100.png", folder + std::to_string(i) + ".png");
    }
    return clip;
  }
  [[nodiscard]] std::vector<LogRow> log() const { return readLog(path("log.csv")); }
  /// A client whose hand stays on the object.
  [[nodiscard]] std::unique_ptr<Process> follow(const std::string& address) const {
    return startClient(
        {address, "--hand", "follow", "--log", path("log.csv"), "--summary", path("summary.json")});
  }
  bool feelsForceAfter(double t_s) const {
    return waitUntil(kSoon, [&] {
      const auto rows = log();
      return !rows.empty() && rows.back().t_s > t_s && rows.back().force_N.norm() > kPushed_N;
    });
  }
  bool feelsNothingAfter(double t_s) const {
    return waitUntil(kSoon, [&] {
      const auto rows = log();
      return !rows.empty() && rows.back().t_s > t_s && rows.back().force_N == Vec3::Zero();
    });
  }
  /// Of the log as it is now.
  [[nodiscard]] double lastTime_s() const { return log().back().t_s; }
  /// Ticks from the last one that had frames around it to the silence in which `quiet` is. Ticks,
  /// not seconds: those that a busy machine leaves out are not the client's.
  static std::ptrdiff_t ticksToSilence(const std::vector<LogRow>& rows,
                                       std::vector<LogRow>::const_iterator quiet) {
    while (quiet != rows.begin() && std::prev(quiet)->force_N == Vec3::Zero()) --quiet;
    auto last = quiet;
    while (last != rows.begin() && std::prev(last)->lookup != "interpolated") --last;
    return quiet - last;
  }
  /// Ends a client that renders a force; the force has to end first.
  void interruptInForce(Process& client) const {
    ASSERT_TRUE(feelsForceAfter(0.0));
    interrupt(client);
    const auto rows = log();
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows.back().force_N, Vec3::Zero());
    const auto summary = summaryIn(path("summary.json"));
    EXPECT_EQ(summary["step_excess_max_N"], 0.0) << summary;
  }

  asio::io_context io;
};

TEST_F(ProgramsLifeTest, AKilledAndAStoppedViewerDoNotDisturbTheOthers) {
  const auto server = startServer({"--source", "synthetic:bounce", "--loop"});
  const std::string address = addressOf(*server);
  std::vector<std::unique_ptr<Process>> clients;
  for (std::size_t i = 0; i < kClients; ++i)
    clients.push_back(startClient({address, "--summary", path(std::to_string(i) + ".json")}));
  for (const auto& client : clients) ASSERT_TRUE(client->says("connected: ", kSoon));
  Process& killed = *clients[0];
  Process& stopped = *clients[1];

  RawPeer viewer(io, portOf(address));
  viewer.send(Hello{kProtocolVersion, "counts", false, true});
  double pinged_s = 0.0;
  const auto lastId = [&] {
    if (now_s() > pinged_s + 1.0) viewer.send(Ping{localTime(pinged_s = now_s())});
    viewer.poll();
    EXPECT_FALSE(viewer.closed);
    const auto frames = viewer.all<CodedFrame>();
    return frames.empty() ? 0 : frames.back().id;
  };
  ASSERT_TRUE(waitUntil(kSoon, [&] { return lastId() > 0; }));
  const long before_kB = server->residentMemory_kB();
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait(kSoon), 128 + SIGKILL);
  stopped.signal(SIGSTOP);
  // Dropped, when it has taken nothing or said nothing for long.
  EXPECT_TRUE(waitUntil(kStart, [&] {
    (void)lastId();
    return countOccurrences("closing 127.0.0.1", server->output()) == 1;
  })) << server->output();
  const long after_kB = server->residentMemory_kB();
  const std::uint64_t last = lastId();
  // The others get a second more to read what the viewer has read.
  EXPECT_TRUE(waitUntil(kSoon, [&] { return lastId() > last + 25; }));
  stopped.signal(SIGCONT);
  EXPECT_TRUE(stopped.says("connected: ", kSoon, 2)) << stopped.output();

  const auto frames = viewer.all<CodedFrame>();
  // On a busy machine this viewer reads late, and the server leaves out frames for it.
  for (std::size_t i = 1; i < frames.size(); ++i) ASSERT_GT(frames[i].id, frames[i - 1].id);
  const std::uint64_t counted = last - frames.front().id + 1;
  std::cout << kClients << " clients, " << counted << " frames counted beside a killed and a "
            << "stopped one; server " << before_kB << " kB before, " << after_kB << " kB after\n";
  if (kFullSpeed) {
    EXPECT_LT(after_kB, before_kB + kGrowth_kB);
  }
  server->signal(SIGUSR1);
  EXPECT_TRUE(server->says(" viewers, ", kSoon)) << "a line of status: " << server->output();
  for (std::size_t i = 1; i < clients.size(); ++i) clients[i]->signal(SIGINT);
  for (std::size_t i = 1; i < clients.size(); ++i) {
    EXPECT_EQ(clients[i]->wait(kSoon), 0) << clients[i]->output();
    if (i == 1) continue;
    const auto summary = summaryIn(path(std::to_string(i) + ".json"));
    EXPECT_EQ(summary["step_excess_max_N"], 0.0) << summary;
    EXPECT_EQ(summary["frames"]["lost"], 0) << summary;
    EXPECT_GE(summary["frames"]["received"], counted) << "client " << i;
    EXPECT_EQ(countOccurrences("connected: ", clients[i]->output()), 1U) << clients[i]->output();
  }
  interrupt(*server);
}

TEST_F(ProgramsLifeTest, AServerThatDiesAndComesBackIsTouchedAgain) {
  keepPorts();
  const std::string clip = stillClip();
  auto server = startServer({"--source", clip, "--loop"});
  const std::string address = addressOf(*server);
  const auto client = follow(address);
  ASSERT_TRUE(feelsForceAfter(0.0)) << client->output();

  server->signal(SIGKILL);
  EXPECT_EQ(server->wait(kSoon), 128 + SIGKILL);
  EXPECT_TRUE(client->says("trying again", kSoon)) << client->output();
  ASSERT_TRUE(feelsNothingAfter(lastTime_s()));
  EXPECT_FALSE(listening(portOf(address)));
  const double quiet_s = lastTime_s();
  // More of the time without a server.
  ASSERT_TRUE(waitUntil(kSoon, [&] { return lastTime_s() > quiet_s + 0.5; }));

  const double again_s = lastTime_s();
  server = startServer({"--source", clip, "--loop"}, address);
  ASSERT_TRUE(client->says("connected: ", kSoon, 2)) << client->output();
  ASSERT_TRUE(feelsForceAfter(lastTime_s())) << client->output();
  interruptInForce(*client);
  interrupt(*server);

  const auto rows = log();
  const auto quiet =
      std::find_if(rows.begin(), rows.end(), [&](const LogRow& row) { return row.t_s >= quiet_s; });
  ASSERT_NE(quiet, rows.end());
  const auto fading = ticksToSilence(rows, quiet);
  std::cout << "force at zero " << fading << " ticks after the last frame\n";
  EXPECT_LT(fading, 1000);
  for (auto row = quiet; row != rows.end() && row->t_s < again_s; ++row)
    ASSERT_EQ(row->force_N, Vec3::Zero()) << "no force without a server";
}

TEST_F(ProgramsLifeTest, AClientStartedBeforeItsServerWaitsForIt) {
  keepPorts();
  const std::string clip = makeClip("clip");
  std::string address;
  {
    const auto first = startServer({"--source", clip, "--loop"});
    address = addressOf(*first);
    interrupt(*first, SIGTERM);
  }
  const auto client = startClient({address, "--seconds", "60"});
  ASSERT_TRUE(client->says("waiting for a server at " + address + " (connection refused)", kSoon))
      << client->output();
  const auto server = startServer({"--source", clip, "--loop"}, address);
  EXPECT_TRUE(client->says("connected: clip, 128 x 96", kSoon))
      << "the clip's name without the server's folders: " << client->output();
  EXPECT_EQ(countOccurrences("waiting for", client->output()), 1U) << client->output();
  interrupt(*client, SIGHUP);
  interrupt(*server);
}

TEST_F(ProgramsLifeTest, ARepeatedStillClipHasNoStepAtItsSeam) {
  const auto server = startServer({"--source", stillClip(25), "--loop"});
  const auto client = follow(addressOf(*server));
  ASSERT_TRUE(feelsForceAfter(0.0)) << client->output();
  const double settled_s = log().back().t_s + 2.0;
  // Rounds of a second each.
  ASSERT_TRUE(waitUntil(kSoon, [&] { return log().back().t_s > settled_s + 4.0; }));
  interrupt(*client);
  interrupt(*server);
  double least_N = 1e9;
  double most_N = 0.0;
  // On a starved machine frames stay out until the force fades, or ticks until it begins anew.
  bool starved = false;
  double before_s = settled_s;
  for (const LogRow& row : log()) {
    if (row.t_s < settled_s || row.t_s > settled_s + 4.0) continue;
    starved = starved || row.lookup == "faded" || row.t_s > before_s + 0.02;
    before_s = row.t_s;
    least_N = std::min(least_N, row.force_N.norm());
    most_N = std::max(most_N, row.force_N.norm());
  }
  std::cout << "force over four wraps: " << least_N << " to " << most_N << " N"
            << (starved ? ", starved\n" : "\n");
  if (kFullSpeed && !starved) {
    EXPECT_GT(least_N, 0.5 * most_N);
  }
}

TEST_F(ProgramsLifeTest, AStoppedServerSendsGoodbye) {
  const auto server = startServer({"--source", stillClip(), "--loop"});
  const auto client = follow(addressOf(*server));
  ASSERT_TRUE(feelsForceAfter(0.0)) << client->output();
  interrupt(*server, SIGTERM);
  EXPECT_TRUE(client->says("the server ends", kSoon)) << client->output();
  EXPECT_TRUE(feelsNothingAfter(log().back().t_s));
  interrupt(*client, SIGTERM);
  EXPECT_EQ(log().back().force_N, Vec3::Zero());
}

TEST_F(ProgramsLifeTest, FilesThatVanishEndALoopWithOneLine) {
  const std::string clip = makeClip("clip");
  const auto server = startServer({"--source", clip, "--loop"});
  ASSERT_TRUE(deliversFrames(addressOf(*server), 14)) << "two rounds: " << server->output();
  std::filesystem::remove_all(clip + "/rgb");
  EXPECT_EQ(server->wait(kSoon), 1) << server->output();
  const std::string text = server->output();
  const std::string last = text.substr(text.rfind('\n', text.size() - 2) + 1);
  EXPECT_NE(last.find("clip/rgb/10"), std::string::npos) << "the first that was missed: " << text;
  EXPECT_NE(last.find(".png: cannot be read"), std::string::npos) << text;
  EXPECT_LE(countOccurrences("cannot be read", text), 2U) << "the rest of the round, and the end";
}

TEST_F(ProgramsLifeTest, AServerThatWaitsPlaysForItsFirstViewer) {
  const std::string clip = makeClip("clip");
  const auto server = startServer({"--source", clip, "--wait-for-viewer"});
  const std::string address = addressOf(*server);
  ASSERT_TRUE(server->says("waiting for the first viewer", kSoon)) << server->output();
  server->signal(SIGUSR1);
  EXPECT_TRUE(server->says("status: 0 viewers, 0 frames", kSoon)) << server->output();
  const auto client = startClient({address, "--summary", path("summary.json")});
  EXPECT_EQ(server->wait(kSoon), 0) << server->output();
  EXPECT_EQ(countOccurrences("waiting for the first viewer", server->output()), 1U);
  interrupt(*client);
  // All of the clip, but for what a starved server says that it left out.
  const int received = summaryIn(path("summary.json"))["frames"].value("received", 0);
  const bool skipped = countOccurrences("frames skipped so far", server->output()) > 0;
  EXPECT_LE(received, skipped ? 5 : 6);
  EXPECT_GE(received, skipped ? 1 : 6) << server->output();
  const auto other = startServer({"--source", clip, "--wait-for-viewer"});
  ASSERT_TRUE(other->says("waiting for the first viewer", kSoon)) << other->output();
  interrupt(*other);
}

TEST_F(ProgramsLifeTest, TheFieldOfViewOverrulesTheClipWithALine) {
  const std::string clip = makeClip("clip");
  (void)write("clip/meta.json", R"({"fov_deg": 60})");
  const auto server = startServer({"--source", clip, "--fov", "75", "--frames", "1"});
  EXPECT_EQ(server->wait(kStart), 0) << server->output();
  EXPECT_EQ(countOccurrences("--fov 75: replaces", server->output()), 1U) << server->output();
  EXPECT_EQ(countOccurrences("(60.0 degrees)", server->output()), 1U) << server->output();
}

TEST_F(ProgramsLifeTest, AClipWithoutLoopEndsTheServer) {
  const auto server = startServer({"--source", makeClip("clip")});
  EXPECT_EQ(server->wait(kStart), 0) << server->output();
  const auto cut = startServer({"--source", makeClip("clip"), "--loop", "--frames", "9"});
  EXPECT_EQ(cut->wait(kStart), 0) << cut->output();
}

}  // namespace
}  // namespace hapticast::testing
