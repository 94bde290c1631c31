// SPDX-License-Identifier: MIT
// Fourteen attacks on the real server while a hundred honest viewers receive: each is bounded, no
// viewer else is touched, the log stays readable, and memory (the system's, too) and file handles
// come back.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include "tests/integration/frame_counter.hpp"

namespace hapticast::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Peers = std::vector<std::unique_ptr<RawPeer>>;
constexpr std::size_t kViewers = 100;
constexpr int kPlaces = 160;

/// Resources of the system for the server's port: sockets that no process has any more, and
/// bytes that wait in the queues of all of them. Counted one by one in /proc/net/tcp: the system's
/// sums belong to everybody on the machine.
struct KeptBySystem {
  int orphans = 0;
  std::uint64_t queued_bytes = 0;

  static KeptBySystem of(std::uint16_t port) {
    constexpr unsigned kSynReceived = 3, kTimeWait = 6;  // neither has a process nor a queue
    std::ifstream file("/proc/net/tcp");
    KeptBySystem found;
    std::string line;
    std::getline(file, line);  // the heads of the columns
    while (std::getline(file, line)) {
      unsigned local_port = 0, state = 0, sent = 0, received = 0, inode = 0;
      if (std::sscanf(line.c_str(), " %*d: %*x:%x %*x:%*x %x %x:%x %*x:%*x %*x %*d %*d %u",
                      &local_port, &state, &sent, &received, &inode) != 5) {
        ADD_FAILURE() << "/proc/net/tcp: " << line;
        continue;
      }
      if (local_port != port || state == kSynReceived || state == kTimeWait) continue;
      found.orphans += inode == 0 ? 1 : 0;
      found.queued_bytes += sent + received;
    }
    return found;
  }
};

/// A hundred viewers on a thread of their own that read every frame and ping as they should.
class HonestViewers {
 public:
  explicit HonestViewers(std::uint16_t port)
      : thread_([this, port](const std::stop_token& stop) {
          for (std::size_t i = 0; i < kViewers; ++i) {
            viewers_.push_back({std::make_unique<RawPeer>(io_, port), 0, {}});
            viewers_.back().peer->send(Hello{kProtocolVersion, "honest", false, true});
          }
          for (LocalTime pinged{}; !stop.stop_requested();) {
            const LocalTime now = SteadyClock().now();
            const bool ping = now - pinged >= seconds(1);  // however long a round takes
            if (ping) pinged = now;
            for (auto& viewer : viewers_) read(viewer, ping);
            ++rounds_;
            restBetweenTurns(milliseconds(10));
          }
        }) {}

  /// Whether all have had `frames` frames more by the deadline.
  bool receive(std::uint64_t frames) {
    const std::uint64_t goal = slowest_ + frames;
    return waitUntil(kSoon, [&] { return slowest_ >= goal; });
  }
  /// Ends them; then the counts below may be read.
  void stop() {
    thread_.request_stop();
    thread_.join();
    viewers_.clear();
  }

  std::atomic<std::uint64_t> slowest_{0};  // frames of whoever has fewest
  std::atomic<int> rounds_{0};
  std::uint64_t frames = 0, lost = 0, wrong = 0, closed = 0;

 private:
  struct Viewer {
    std::unique_ptr<RawPeer> peer;
    std::uint64_t frames = 0;
    std::optional<std::uint64_t> last_id;
  };
  void read(Viewer& viewer, bool ping) {
    if (viewer.peer->closed) return;
    if (ping) viewer.peer->send(Ping{});
    viewer.peer->poll();
    closed += viewer.peer->closed ? 1 : 0;
    for (const CodedFrame& frame : viewer.peer->all<CodedFrame>()) {
      if (viewer.last_id) {
        wrong += frame.id <= *viewer.last_id ? 1 : 0;
        lost += frame.id > *viewer.last_id + 1 ? frame.id - *viewer.last_id - 1 : 0;
      }
      viewer.last_id = frame.id;
      ++viewer.frames;
      ++frames;
    }
    viewer.peer->got.clear();
    std::uint64_t fewest = UINT64_MAX;
    for (const Viewer& each : viewers_) fewest = std::min(fewest, each.frames);
    slowest_ = fewest;
  }

  asio::io_context io_;
  std::vector<Viewer> viewers_;
  std::jthread thread_;  // last: it uses the others
};

class ProgramsAttacksTest : public ProgramsTest {
 protected:
  std::unique_ptr<RawPeer> peer() { return std::make_unique<RawPeer>(io_, port_); }
  Peers peers(int count) {
    Peers made;
    for (int i = 0; i < count; ++i) made.push_back(peer());
    return made;
  }
  std::unique_ptr<RawPeer> welcomed(bool wants_video = false) {
    auto made = peer();
    made->send(Hello{kProtocolVersion, "attacker", wants_video, true});
    return made;
  }
  /// Whether the server answers each of them, which then are no silent viewers.
  static bool areAnswered(const Peers& peers) {
    const bool all = waitUntil(kSoon, [&] {
      for (const auto& each : peers) each->poll();
      return std::all_of(peers.begin(), peers.end(),
                         [](const auto& each) { return each->closed || !each->got.empty(); });
    });
    for (const auto& each : peers) each->send(Ping{});
    return all;
  }
  /// Whether the server ends this connection, at once or soon.
  static bool isClosed(RawPeer& peer) {
    return waitUntil(kSoon, [&] {
      peer.poll();
      return peer.closed;
    });
  }
  /// Whether the server lets go of all peers but the honest viewers, though these peers do not go.
  bool letsGo() {
    return waitUntil(kStart, [this] { return filesOf(*server_) <= files_; });
  }
  /// How soon somebody new is welcomed; nullopt if never.
  std::optional<milliseconds> newcomer() {
    const auto begin = std::chrono::steady_clock::now();
    const auto made = peer();
    made->send(Hello{kProtocolVersion, "newcomer", false, true});
    const auto welcomed = [&] {
      made->poll();
      return !made->all<Welcome>().empty();
    };
    if (!waitUntil(kSoon, welcomed)) return std::nullopt;
    return std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begin);
  }
  static std::size_t filesOf(const Process& server) {
    const std::filesystem::path folder = "/proc/" + std::to_string(server.id()) + "/fd";
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }
  std::vector<std::uint8_t> noise(std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random_());
    return bytes;
  }
  static std::vector<std::uint8_t> length(std::uint32_t bytes) {
    const LengthPrefix prefix = lengthPrefix(bytes);
    return {prefix.begin(), prefix.end()};
  }
  /// A report padded to 64 KiB with a field that nobody knows.
  static std::vector<std::uint8_t> longReport() {
    std::vector<std::uint8_t> payload = encode(ReceiverReport{});
    const std::size_t rest = kMaxSmallMessageBytes - payload.size() - 5;
    payload.insert(payload.end(), {0xFA, 0x7F});  // field 2047, bytes
    for (const unsigned shift : {0U, 7U, 14U}) {
      payload.push_back(
          static_cast<std::uint8_t>((rest >> shift & 0x7FU) | (shift < 14 ? 0x80U : 0U)));
    }
    payload.resize(kMaxSmallMessageBytes, 'x');
    return framed(payload);
  }

  struct Attack {
    const char* name;
    std::function<void()> run;
  };
  std::vector<Attack> attacks();

  asio::io_context io_;
  std::unique_ptr<Process> server_;
  std::size_t files_ = 0;  // of the server with the honest viewers
  std::uint16_t port_ = 0;
  std::mt19937 random_{20261122};
};

std::vector<ProgramsAttacksTest::Attack> ProgramsAttacksTest::attacks() {
  return {
      {"opened and left",
       [this] {
         for (int i = 0; i < 2000; ++i) (void)peer();
       }},
      {"kept full with silence",
       [this] {
         Peers hog;
         for (int i = 1; i <= 2000; ++i) {
           hog.push_back(peer());
           if (hog.size() > kPlaces + 64) hog.erase(hog.begin());
           if (i % 200 == 0) {
             EXPECT_TRUE(newcomer()) << "kept out";
           }
         }
       }},
      {"a byte now and then",
       [this] {
         Peers slow = peers(30);
         EXPECT_TRUE(waitUntil(kSoon, [&, turn = 0]() mutable {
           const bool sends = turn++ % 10 == 0;
           for (const auto& each : slow) {
             if (sends) each->send(std::vector<std::uint8_t>{1});
             each->poll();
           }
           return std::all_of(slow.begin(), slow.end(),
                              [](const auto& each) { return each->closed; });
         })) << "they say no hello";
       }},
      {"random bytes",
       [this] {
         for (int i = 0; i < 400; ++i) peer()->send(noise(2000));
       }},
      {"lengths",
       [this] {
         Peers kept;
         for (const std::uint32_t bytes : {0U, 65537U, 0x7FFFFFFFU, 0xFFFFFFFFU, 65536U}) {
           for (int i = 0; i < 20; ++i) {
             kept.push_back(peer());
             kept.back()->send(length(bytes));
           }
         }
         for (const auto& each : kept) EXPECT_TRUE(isClosed(*each));
       }},
      {"hello storm",
       [this] {
         for (int i = 0; i < 1500; ++i) (void)welcomed(true);
       }},
      {"wrong versions",
       [this] {
         for (int i = 0; i < 600; ++i)
           peer()->send(Hello{kProtocolVersion + 1, "future", true, true});
       }},
      {"pings as fast as they go",
       [this] {
         const auto made = welcomed();
         const std::vector<std::uint8_t> ping = framed(encode(Ping{}));
         EXPECT_TRUE(waitUntil(kSoon, [&] {
           for (int i = 0; i < 1000; ++i) made->send(ping);
           made->poll();
           return made->closed;
         }));
       }},
      {"long reports",
       [this] {
         const std::vector<std::uint8_t> report = longReport();
         Peers made;
         for (int i = 0; i < 10; ++i) made.push_back(welcomed());
         for (int round = 0; round < 300; ++round) {
           for (const auto& each : made) each->send(report);
           restBetweenTurns(milliseconds(6));
         }
       }},
      {"a flood of reports",
       [this] {
         const std::vector<std::uint8_t> report = longReport();
         for (int i = 0; i < 20; ++i) {
           const auto made = welcomed();
           for (int k = 0; k < 300; ++k) made->send(report);
         }
       }},
      {"hello, then never read",
       [this] {
         Peers stalled;
         for (int i = 0; i < 40; ++i) stalled.push_back(welcomed(true));
         EXPECT_TRUE(letsGo());
       }},
      {"hello and garbage",
       [this] {
         for (int i = 0; i < 300; ++i) {
           const auto made = welcomed();
           made->send(i % 2 == 0 ? noise(500) : framed(noise(500)));
         }
       }},
      {"half closed, never read",
       [this] {
         Peers half;
         for (int i = 0; i < 40; ++i) {
           half.push_back(welcomed(true));
           half.back()->finish();
         }
         EXPECT_TRUE(letsGo());
       }},
      {"more than there are places for",
       [this] {
         Peers many;
         for (int i = 0; i < kPlaces; ++i) many.push_back(welcomed());
         EXPECT_TRUE(areAnswered(many));
         const auto late = welcomed();
         EXPECT_TRUE(isClosed(*late));
         ASSERT_FALSE(late->all<WireError>().empty());
         EXPECT_EQ(late->all<WireError>()[0].code, ErrorCode::kServerFull);
       }},
  };
}

TEST_F(ProgramsAttacksTest, AreAllBounded) {
  const auto begin = std::chrono::steady_clock::now();
  server_ = startStillServer({"--max-clients", std::to_string(kPlaces)});
  Process* const server = server_.get();
  port_ = portOf(addressOf(*server));
  ASSERT_TRUE(server->says("streaming", kStart));
  const std::size_t files_before = filesOf(*server);
  HonestViewers viewers(port_);
  ASSERT_TRUE(viewers.receive(10)) << server->output();
  files_ = filesOf(*server);
  const long resident_before_kB = server->residentMemory_kB();
  for (const Attack& attack : attacks()) {
    SCOPED_TRACE(attack.name);
    attack.run();
    EXPECT_TRUE(server->running()) << server->output();
    const auto welcome = newcomer();
    EXPECT_TRUE(welcome) << "nobody new gets in";
    EXPECT_TRUE(viewers.receive(5)) << "the others get nothing any more";
    const KeptBySystem kept = KeptBySystem::of(port_);
    std::printf(
        "%-32s newcomer in after %3lld ms, %3zu files, RSS %+6ld kB, %3d orphans, %9llu B\n",
        attack.name, welcome ? static_cast<long long>(welcome->count()) : -1LL, filesOf(*server),
        server->residentMemory_kB() - resident_before_kB, kept.orphans,
        static_cast<unsigned long long>(kept.queued_bytes));
  }
  viewers.stop();
  std::printf("honest viewers: %llu frames, %llu lost, %llu wrong, %llu closed\n",
              static_cast<unsigned long long>(viewers.frames),
              static_cast<unsigned long long>(viewers.lost),
              static_cast<unsigned long long>(viewers.wrong),
              static_cast<unsigned long long>(viewers.closed));
  EXPECT_EQ(viewers.closed, 0U);
  EXPECT_EQ(viewers.wrong, 0U);
  EXPECT_LT(viewers.lost, viewers.frames / 20) << "a starved machine loses some";

  EXPECT_TRUE(waitUntil(kSoon, [&] { return filesOf(*server) <= files_before; }))
      << filesOf(*server) << " open files";
  const auto nothing_kept = [&] {
    const KeptBySystem kept = KeptBySystem::of(port_);
    return kept.orphans == 0 && kept.queued_bytes == 0;
  };
  EXPECT_TRUE(waitUntil(kSoon, nothing_kept))
      << KeptBySystem::of(port_).orphans << " orphans, " << KeptBySystem::of(port_).queued_bytes
      << " bytes queued";
  if (kFullSpeed) {
    EXPECT_LT(server->residentMemory_kB() - resident_before_kB, 40'000);
  }
  const double minutes =
      std::chrono::duration<double, std::ratio<60>>(std::chrono::steady_clock::now() - begin)
          .count();
  EXPECT_LE(static_cast<double>(countOccurrences("\n", server->output())),
            4.0 + 20.0 * std::ceil(minutes))
      << server->output();
  interrupt(*server);
}

/// As many viewers are asked for as the system has files for, and more.
TEST_F(ProgramsAttacksTest, ReportsAFewOpenFilesAndKeepsNoViewerWaiting) {
  const auto server = start(
      "/bin/sh", {"-c", "ulimit -n 150; exec \"$0\" \"$@\"", HAPTICAST_SERVER_PROGRAM, "--source",
                  "synthetic:still", "--loop", "--listen", "127.0.0.1:0", "--max-clients", "2000"});
  port_ = portOf(addressOf(*server));
  EXPECT_TRUE(server->says("--max-clients 2000: this system allows 150 open files", kSoon));
  Peers many = peers(200);
  for (const auto& each : many) each->send(Hello{kProtocolVersion, "many", false, true});
  const auto late = peer();
  late->send(Hello{kProtocolVersion, "late", false, true});
  EXPECT_TRUE(waitUntil(kSoon, [&] {
    late->poll();
    return late->closed || !late->got.empty();
  }));
  for (const auto& each : many) {
    each->poll();
    EXPECT_FALSE(each->closed && !each->all<Welcome>().empty())
        << "it hears that the server is full, and does not wait until somebody leaves";
  }
  EXPECT_EQ(server->output().find("cannot accept"), std::string::npos) << server->output();
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
