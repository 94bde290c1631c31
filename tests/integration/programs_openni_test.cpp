// SPDX-License-Identifier: MIT
// Server and client with a camera of OpenNI2: the real library with a driver of our own
// (tests/openni/driver.cpp), which unplugs the camera at the test's order.
#include <nlohmann/json.hpp>

#include "common/build_options.hpp"
#include "tests/integration/programs_fixture.hpp"
#include "tests/support/openni_orders.hpp"

namespace hapticast::testing {
namespace {

class ProgramsOpenniTest : public ProgramsTest {
 protected:
  void SetUp() override {
    if (!kHasOpenni) GTEST_SKIP() << "this build has no OpenNI2";
  }

  [[nodiscard]] std::unique_ptr<Process> startWithCamera(std::vector<std::string> more) const {
    const std::string suppressions =
        std::string("LSAN_OPTIONS=suppressions=") + HAPTICAST_TESTS + "/support/lsan.supp";
    const std::string library_path = std::string("LD_LIBRARY_PATH=") + HAPTICAST_OPENNI_FOLDER;
    std::vector<std::string> arguments{suppressions,
                                       library_path,
                                       "HAPTICAST_OPENNI_ORDERS=" + camera_.file(),
                                       HAPTICAST_SERVER_PROGRAM,
                                       "--listen",
                                       "127.0.0.1:0",
                                       "--source"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("/usr/bin/env", std::move(arguments));
  }
  /// Whether the client presses with a force from row `begin` of its log on, `ticks` times.
  [[nodiscard]] bool presses(std::size_t begin, long ticks) const {
    return waitUntil(kSoon, [&] {
      const auto rows = readLog(path("log.csv"));
      if (rows.size() <= begin) return false;
      return std::count_if(rows.begin() + static_cast<long>(begin), rows.end(),
                           [](const LogRow& row) { return row.force_N.norm() > 0.3; }) > ticks;
    });
  }
  /// How many ticks at the end of the client's log have no force.
  [[nodiscard]] long countTicksWithoutForce() const {
    const auto rows = readLog(path("log.csv"));
    const auto last = std::find_if(rows.rbegin(), rows.rend(),
                                   [](const LogRow& row) { return row.force_N != Vec3::Zero(); });
    return last - rows.rbegin();
  }

  OpenniOrders camera_{path("orders")};
};

TEST_F(ProgramsOpenniTest, AnUnpluggedCameraFadesTheForceAndComesBack) {
  const auto server = startWithCamera({"openni:", "--object", "64,48"});
  const auto client = startClient({addressOf(*server), "--device", "virtual", "--hand", "press",
                                   "--log", path("log.csv"), "--summary", path("sum.json")});
  EXPECT_TRUE(presses(0, 1000)) << client->output();
  camera_.order({{"plugged", 0}});
  EXPECT_TRUE(server->says("openni: was unplugged; the server tries", kSoon)) << server->output();
  EXPECT_TRUE(client->says("no new frames arrive: the force has faded", kSoon)) << client->output();
  // Three seconds without any force.
  ASSERT_TRUE(waitUntil(kSoon, [&] { return countTicksWithoutForce() > 3000; }));
  const std::size_t away = readLog(path("log.csv")).size();
  camera_.order({{"plugged", 1}});
  EXPECT_TRUE(server->says("openni: frames are back", kSoon)) << server->output();
  EXPECT_TRUE(presses(away, 1000)) << client->output();
  interrupt(*client);
  interrupt(*server);
  // Not all warnings: on a starved machine the camera may be silent for a second, which is one,
  // too.
  EXPECT_EQ(countOccurrences("was unplugged", server->output()), 1U) << server->output();
  const auto summary = nlohmann::json::parse(std::ifstream(path("sum.json")));
  EXPECT_EQ(summary["step_excess_max_N"], 0.0);
  EXPECT_EQ(summary["frames"]["malformed"], 0);
}

TEST_F(ProgramsOpenniTest, CtrlCEndsTheServerWhileTheCameraIsAway) {
  const auto server = startWithCamera({"openni:"});
  ASSERT_TRUE(server->says("streaming openni:", kSoon)) << server->output();
  camera_.order({{"plugged", 0}});
  ASSERT_TRUE(server->says("was unplugged", kSoon)) << server->output();
  interrupt(*server);
}

TEST_F(ProgramsOpenniTest, AWrongStartIsOneLine) {
  camera_.order({{"plugged", 0}});
  const auto none = startWithCamera({"openni:", "--quiet"});
  EXPECT_EQ(none->wait(kSoon), 2);
  EXPECT_TRUE(none->output().ends_with(
      "error --source openni: no OpenNI2 device was found; plug one in, or check the udev rules\n"))
      << none->output();
  camera_.order({{"plugged", 1}, {"color", 0}});
  const auto grey = startWithCamera({"openni:0", "--quiet"});
  EXPECT_EQ(grey->wait(kSoon), 2);
  EXPECT_EQ(countOccurrences("\n", grey->output()), 1U) << grey->output();
}

}  // namespace
}  // namespace hapticast::testing
