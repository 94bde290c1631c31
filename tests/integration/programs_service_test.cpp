// SPDX-License-Identifier: MIT
// The server as a service: SIGHUP reads the configuration again, systemd gets reports, and its
// journal gets lines without a time. A socket of the test stands in the place of systemd's.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>

#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

/// A viewer, and the stiffness in its newest frame. Values of the test are exact in 32 bits.
class SystemdSocket {
 public:
  SystemdSocket(asio::io_context& io, const std::string& address)
      : peer_(io, static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)))) {
    peer_.send(Hello{kProtocolVersion, "reload", false, true});
  }
  std::optional<double> stiffness_N_mm() {
    const LocalTime now = SteadyClock().now();
    if (now > pinged_ + std::chrono::seconds(1)) peer_.send(Ping{pinged_ = now});
    peer_.poll();
    const auto frames = peer_.all<CodedFrame>();
    frames_ = frames.size();
    if (frames.empty() || frames.back().objects.empty()) return std::nullopt;
    return frames.back().objects.front().material.stiffness_N_mm;
  }
  bool sees(double stiffness_N_mm_wanted) {
    return waitUntil(kSoon, [&] { return stiffness_N_mm() == stiffness_N_mm_wanted; });
  }
  /// Whether further frames come.
  bool goesOn() {
    (void)stiffness_N_mm();
    return waitUntil(kSoon, [this, before = frames_] {
      (void)stiffness_N_mm();
      return frames_ > before + 5;
    });
  }
  [[nodiscard]] bool closed() const { return peer_.closed; }

 private:
  RawPeer peer_;
  LocalTime pinged_{};
  std::size_t frames_ = 0;
};

/// The socket to which a service reports, and all that it reported, a line for each message.
class ReportSocket {
 public:
  explicit ReportSocket(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~ReportSocket() { ::close(socket_); }
  ReportSocket(const ReportSocket&) = delete;
  ReportSocket& operator=(const ReportSocket&) = delete;

  /// Whether `text` arrives `times` times before a deadline.
  bool receives(const std::string& text, std::size_t times = 1) {
    return waitUntil(kSoon, [&] {
      poll();
      return countOccurrences(text, all_) >= times;
    });
  }
  /// Reads what has arrived. An unread socket holds ten messages, then a server waits.
  void poll() {
    std::array<char, 1024> message{};
    for (ssize_t size = 0;
         (size = ::recv(socket_, message.data(), message.size(), MSG_DONTWAIT)) > 0;)
      all_.append(message.data(), static_cast<std::size_t>(size)).append("\n");
  }
  [[nodiscard]] const std::string& all() const { return all_; }

 private:
  int socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::string all_;
};

class ProgramsServiceTest : public ProgramsTest {
 protected:
  asio::io_context io;
};

TEST_F(ProgramsServiceTest, AViewerGetsTheNewMaterialAndAFileWithAnErrorChangesNothing) {
  const std::string config = write("server.conf", "stiffness = 0.5\nmass = 0.2\n");
  const auto server = startServer({"--source", "synthetic:bounce", "--loop", "--config", config});
  SystemdSocket viewer(io, addressOf(*server));
  ASSERT_TRUE(viewer.sees(0.5));

  write("server.conf", "stiffness = 0.75\nmax-clients = 2\n");
  server->signal(SIGHUP);
  EXPECT_TRUE(server->says("changed: --mass, --stiffness", kSoon)) << server->output();
  EXPECT_TRUE(server->says("take effect at the next start: --max-clients", kSoon));
  EXPECT_TRUE(viewer.sees(0.75)) << server->output();

  write("server.conf", "stiffness = 0.25\nstifness = 0.2\n");
  server->signal(SIGHUP);
  EXPECT_TRUE(server->says("server.conf:2: 'stifness' is not the name of a flag", kSoon))
      << server->output();
  EXPECT_TRUE(server->says("the settings stay as they are", kSoon)) << server->output();
  EXPECT_TRUE(viewer.goesOn());
  EXPECT_EQ(viewer.stiffness_N_mm(), 0.75);
  EXPECT_FALSE(viewer.closed());
  interrupt(*server);
}

TEST_F(ProgramsServiceTest, SystemdReceivesStartReloadEndAndTheWatchdogsSign) {
  ReportSocket systemd(path("notify"));
  const auto server =
      start("/usr/bin/env",
            {"NOTIFY_SOCKET=" + path("notify"), "WATCHDOG_USEC=400000", HAPTICAST_SERVER_PROGRAM,
             "--source", "synthetic:still", "--wait-for-viewer", "--listen", "127.0.0.1:0"});
  EXPECT_TRUE(systemd.receives("READY=1\nSTATUS=synthetic:still: listening on 127.0.0.1:"))
      << systemd.all() << server->output();
  ASSERT_TRUE(waitUntil(kStart, [&] {
    systemd.poll();
    return server->output().find("waiting for the first viewer") != std::string::npos;
  })) << server->output();
  const std::size_t before = countOccurrences("WATCHDOG=1\n", systemd.all());
  EXPECT_TRUE(systemd.receives("WATCHDOG=1\n", before + 5)) << "while no viewer is there";
  server->signal(SIGHUP);
  EXPECT_TRUE(systemd.receives("RELOADING=1\nMONOTONIC_USEC=")) << systemd.all();
  EXPECT_TRUE(systemd.receives("READY=1\n", 2)) << systemd.all();
  interrupt(*server, SIGTERM);
  EXPECT_TRUE(systemd.receives("STOPPING=1\n")) << systemd.all();
}

TEST_F(ProgramsServiceTest, LinesForTheJournalHaveNoTime) {
  const std::string as_a_service = "JOURNAL_STREAM=$(stat -Lc %d:%i /proc/self/fd/2) exec \"$@\"";
  const std::vector<std::string> wrong{"-c", as_a_service, "sh", HAPTICAST_SERVER_PROGRAM,
                                       "--speed"};
  const auto server = start("/bin/sh", wrong);
  EXPECT_EQ(server->wait(kSoon), 2);
  EXPECT_TRUE(server->output().starts_with("error not understood: '--speed'")) << server->output();
  const auto by_hand =
      start("/usr/bin/env", {"JOURNAL_STREAM=1:2", HAPTICAST_SERVER_PROGRAM, "--speed"});
  EXPECT_EQ(by_hand->wait(kSoon), 2);
  EXPECT_FALSE(by_hand->output().starts_with("error")) << "stderr is not the journal's";
}

}  // namespace
}  // namespace hapticast::testing
