// SPDX-License-Identifier: MIT
// Keys of servers, by the real programs: --signing-key and --origin-key.
#include <cstdlib>

#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsOriginTest : public ProgramsTest {
 protected:
  [[nodiscard]] std::unique_ptr<Process> startOrigin(const std::string& key_file,
                                                     const std::string& address = "127.0.0.1:0") {
    return startServer({"--source", "synthetic:still", "--loop", "--signing-key", path(key_file)},
                       address);
  }
  /// The key that the server logs.
  static std::string keyOf(Process& server) {
    EXPECT_TRUE(server.says("origin key: ", kStart)) << server.output();
    const std::string text = server.output();
    return text.substr(text.find("origin key: ") + std::string("origin key: ").size(), 64);
  }
  [[nodiscard]] static std::unique_ptr<Process> startViewer(const std::string& address,
                                                            const std::string& key) {
    return startClient({address, "--origin-key", key, "--device", "virtual", "--view", "off"});
  }
};

TEST_F(ProgramsOriginTest, TheFirstKeyIsRemembered) {
  keepPorts();
  auto server = startOrigin("origin.pem");
  const std::string address = addressOf(*server);
  const std::string key = keyOf(*server);
  for (int run = 0; run < 2; ++run) {
    if (run == 1) {
      interrupt(*server);
      server = startOrigin("origin.pem", address);
      EXPECT_EQ(keyOf(*server), key) << "the same in each run";
      (void)addressOf(*server);
    }
    const auto viewer = startViewer(address, "first");
    EXPECT_TRUE(viewer->says("connected: ", kSoon)) << viewer->output();
    interrupt(*viewer);
  }
  const std::string file = path("state/hapticast/known_origins");
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, address + " " + key);
  interrupt(*server);
  server = startOrigin("other.pem", address);
  (void)addressOf(*server);
  const auto viewer = startViewer(address, "first");
  EXPECT_EQ(viewer->wait(kSoon), 1);
  EXPECT_NE(viewer->output().find("error the server at " + address + " shows the key " +
                                  keyOf(*server) + ", not the expected one: "),
            std::string::npos)
      << viewer->output();
  EXPECT_NE(viewer->output().find("delete line 1 of " + file), std::string::npos)
      << viewer->output();
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
