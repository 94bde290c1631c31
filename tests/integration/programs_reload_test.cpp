// SPDX-License-Identifier: MIT
// SIGHUP: a running server reads its configuration again.
#include <csignal>

#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

/// A viewer, and the stiffness in its newest frame. Values of the test are exact in 32 bits.
class Watcher {
 public:
  Watcher(asio::io_context& io, const std::string& address)
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

class ProgramsReloadTest : public ProgramsTest {
 protected:
  asio::io_context io;
};

TEST_F(ProgramsReloadTest, AViewerGetsTheNewMaterialAndAFileWithAnErrorChangesNothing) {
  const std::string config = write("server.conf", "stiffness = 0.5\nmass = 0.2\n");
  const auto server = startServer({"--source", "synthetic:bounce", "--loop", "--config", config});
  Watcher viewer(io, addressOf(*server));
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

}  // namespace
}  // namespace hapticast::testing
