// SPDX-License-Identifier: MIT
#include "server/show/reload.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <csignal>

#include "common/cli/run_program.hpp"
#include "server/settings/command_line.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {
namespace {

/// A server's command line with a config file and a scene file that a test rewrites.
class ReloadTest : public testing::Test {
 protected:
  ReloadTest() {
    writeScene("\"stiffness\": 0.3");
    writeConfig("stiffness = 0.5");
  }
  ~ReloadTest() override { spdlog::set_level(spdlog::level::info); }

  void writeConfig(const std::string& lines) const { (void)folder_.write("server.conf", lines); }
  void writeScene(const std::string& member) const {
    (void)folder_.write("scene.json", R"({"version": 1, "objects": [{"name": "ball", )"
                                      R"("points": ["1,2"], )" +
                                          member + "}]}");
  }
  [[nodiscard]] Result<Settings> read() const {
    const std::string config = (folder_ / "server.conf").string();
    const std::string scene = (folder_ / "scene.json").string();
    const char* const arguments[] = {"hapticast-server", "--source", "synthetic:still", "--config",
                                     config.c_str(),     "--scene",  scene.c_str()};
    return rereadCommandLine(static_cast<int>(std::size(arguments)), arguments);
  }
  [[nodiscard]] Reloader start() const {
    return Reloader(
        read().value(), [this] { return read(); }, clock_);
  }

  const TempFolder folder_;
  ManualClock clock_;
  LogLines log_;
};

TEST_F(ReloadTest, MaterialsTakeEffectAtOnce) {
  Reloader reloader = start();
  writeConfig("stiffness = 2\nfriction = 0.4,0.2\nmass = 0.1\ntexture-depth = 10\ndamping = 3");
  writeScene("\"stiffness\": 0.7");
  const auto vision = reloader.reload();
  ASSERT_TRUE(vision.has_value());
  EXPECT_EQ(vision->material.stiffness_N_mm, 2.0);
  EXPECT_EQ(vision->material.static_friction, 0.4);
  EXPECT_EQ(vision->material.texture_K_mm, 10.0);
  EXPECT_EQ(vision->material.damping_Ns_m, 3.0);
  EXPECT_EQ(vision->mass_kg, 0.1);
  EXPECT_EQ(vision->findMaterial(1).stiffness_N_mm, 0.7);
  EXPECT_EQ(log_.text(),
            "info configuration read again; changed: --damping, --friction, --mass, --stiffness, "
            "--texture-depth, materials of the scene's objects\n");
  log_.forget();
  EXPECT_TRUE(reloader.reload().has_value());
  EXPECT_EQ(log_.text(), "info configuration read again; changed: nothing\n");
}

TEST_F(ReloadTest, ARemovedKeyReturnsToItsDefault) {
  Reloader reloader = start();
  writeConfig("");
  const auto vision = reloader.reload();
  ASSERT_TRUE(vision.has_value());
  EXPECT_EQ(vision->material.stiffness_N_mm, std::nullopt);
}

TEST_F(ReloadTest, OtherChangesAreNamedAndWaitForTheNextStart) {
  Reloader reloader = start();
  writeConfig("stiffness = 0.5\nlisten = 7500\nmax-clients = 3\nmap-range = 500,900");
  (void)folder_.write("scene.json",
                      R"({"version": 1, "objects": [{"name": "ball", "points": ["9,9"]}]})");
  const auto vision = reloader.reload();
  ASSERT_TRUE(vision.has_value());
  EXPECT_EQ(vision->map_range, std::nullopt);
  EXPECT_NE(log_.text().find("warning these changes take effect at the next start: --listen, "
                             "--map-range, --max-clients, --scene"),
            std::string::npos)
      << log_.text();
  EXPECT_EQ(log_.count(), 2);
}

TEST_F(ReloadTest, OtherObjectsKeepTheOldMaterials) {
  Reloader reloader = start();
  (void)folder_.write("scene.json", R"({"version": 1, "objects": []})");
  const auto vision = reloader.reload();
  ASSERT_TRUE(vision.has_value());
  EXPECT_EQ(vision->findMaterial(1).stiffness_N_mm, 0.3);
  EXPECT_NE(log_.text().find("next start: --scene"), std::string::npos) << log_.text();
}

TEST_F(ReloadTest, AnErrorIsOneLineAndChangesNothing) {
  Reloader reloader = start();
  for (const char* wrong : {"stiffness = 0.6\nspeed = 1", "stiffness = 99", "stiffness 0.6"}) {
    log_.forget();
    writeConfig(wrong);
    EXPECT_EQ(reloader.reload(), std::nullopt);
    EXPECT_EQ(log_.count(), 1) << log_.text();
    EXPECT_NE(log_.text().find("server.conf"), std::string::npos) << log_.text();
    EXPECT_NE(log_.text().find("the settings stay as they are"), std::string::npos) << log_.text();
  }
  std::filesystem::remove(folder_ / "server.conf");
  EXPECT_EQ(reloader.reload(), std::nullopt);
  log_.forget();
  writeConfig("stiffness = 0.5");
  EXPECT_TRUE(reloader.reload().has_value());
  EXPECT_EQ(log_.text(), "info configuration read again; changed: nothing\n");
}

TEST_F(ReloadTest, ManyReloadsDoNotFillTheLog) {
  Reloader reloader = start();
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(reloader.reload().has_value());
  EXPECT_EQ(log_.count(), RateLimiter::kLogBurst);
  writeConfig("stiffness = 99");
  log_.forget();
  for (int i = 0; i < 100; ++i) EXPECT_EQ(reloader.reload(), std::nullopt);
  EXPECT_EQ(log_.count(), RateLimiter::kLogBurst) << "usual lines hide no error";
  log_.forget();
  clock_.advance(RateLimiter::kLogRefill);
  EXPECT_EQ(reloader.reload(), std::nullopt);
  EXPECT_NE(log_.text().find(" (and 94 lines more, not shown)\n"), std::string::npos)
      << log_.text();
}

TEST_F(ReloadTest, QuietTakesEffectAtOnce) {
  Reloader reloader = start();
  writeConfig("stiffness = 0.5\nquiet = true");
  EXPECT_TRUE(reloader.reload().has_value());
  EXPECT_EQ(spdlog::get_level(), spdlog::level::warn);
  writeConfig("stiffness = 0.5");
  EXPECT_TRUE(reloader.reload().has_value());
  EXPECT_EQ(spdlog::get_level(), spdlog::level::info);
}

TEST(Sighup, OfATerminalItEndsTheProgramElseItReloads) {
  const int before = ::dup(STDIN_FILENO);
  const auto reloads_with = [](int input) {
    EXPECT_EQ(::dup2(input, STDIN_FILENO), STDIN_FILENO);
    ::close(input);
    return sighupReloads();
  };
  EXPECT_TRUE(reloads_with(::open("/dev/null", O_RDONLY)));
  std::signal(SIGHUP, SIG_IGN);  // nohup
  EXPECT_FALSE(sighupReloads());
  std::signal(SIGHUP, SIG_DFL);
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_EQ(::unlockpt(terminal), 0);
  EXPECT_FALSE(reloads_with(::open(::ptsname(terminal), O_RDONLY | O_NOCTTY)));
  ::close(terminal);
  ::dup2(before, STDIN_FILENO);
  ::close(before);
}

}  // namespace
}  // namespace hapticast::server
