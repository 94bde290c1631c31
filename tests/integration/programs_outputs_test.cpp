// SPDX-License-Identifier: MIT
// Outputs that cannot be written: a log whose reader has ended, and a full disk.
#include <nlohmann/json.hpp>

#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsOutputsTest : public ProgramsTest {
 protected:
  /// Mounts a disk of 4 kB. Returns false where that needs rights.
  [[nodiscard]] bool mountSmallDisk() {
    std::filesystem::create_directories(path("disk"));
    mounted_ =
        std::system(
            ("mount -t tmpfs -o size=4k tmpfs '" + path("disk") + "' 2>/dev/null").c_str()) == 0;
    return mounted_;
  }
  void TearDown() override {
    if (mounted_) {
      EXPECT_EQ(std::system(("umount '" + path("disk") + "'").c_str()), 0);
    }
  }
  /// Starts a program whose log goes to a program that reads one line.
  static std::unique_ptr<Process> startUnread(const std::string& program,
                                              const std::string& arguments) {
    return std::make_unique<Process>(
        std::vector<std::string>{"/bin/sh", "-c",
                                 "{ '" + program + "' " + arguments +
                                     "; echo \"ended with $?\" >&3; } 3>&2 2>&1 | head -n 1"});
  }

 private:
  bool mounted_ = false;
};

TEST_F(ProgramsOutputsTest, ALogWithoutAReaderEndsNoProgram) {
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  const auto client = startUnread(HAPTICAST_CLIENT_PROGRAM,
                                  address + " --device virtual --hand press --seconds 2 --log '" +
                                      path("run.csv") + "' --summary '" + path("run.json") + "'");
  EXPECT_TRUE(client->says("ended with 0", kSoon)) << client->output();
  const auto rows = readLog(path("run.csv"));
  EXPECT_FALSE(rows.empty());
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(path("run.json")))["ticks"], rows.size());
  EXPECT_GT(std::filesystem::file_size(path("run.json")), 100U);
  interrupt(*server);
  const auto unread = startUnread(HAPTICAST_SERVER_PROGRAM,
                                  "--source synthetic:still --frames 50 --listen 127.0.0.1:0");
  EXPECT_TRUE(unread->says("ended with 0", kSoon)) << unread->output();
}

TEST_F(ProgramsOutputsTest, AFullDiskIsOneLineAndAnExitCode) {
  if (!mountSmallDisk()) GTEST_SKIP() << "only root can mount a small disk";
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  struct Row {
    const char* flag;
    const char* file;
    const char* cause;
  };
  for (const Row& row : {
           Row{"--film", "a.mp4", "a.mp4: not written completely; is the disk full?"},
           Row{"--screenshot", "a.png", "a.png: cannot be written (No space left on device)"},
       }) {
    const auto client =
        startClient({address, "--device", "virtual", "--hand", "press", "--seconds", "2", "--quiet",
                     row.flag, path(std::string("disk/") + row.file)});
    EXPECT_EQ(client->wait(kSoon), 1) << row.flag << client->output();
    const std::string text = client->output();
    EXPECT_NE(text.find(row.cause), std::string::npos) << text;
    EXPECT_EQ(countOccurrences(row.file, text), 1U) << text;
    EXPECT_EQ(countOccurrences(" error ", text), 1U) << text;
  }
  interrupt(*server);
  const auto preview = start(HAPTICAST_SERVER_PROGRAM, {"--source", makeClip("clip"), "--preview",
                                                        path("disk/p.png"), "--quiet"});
  EXPECT_EQ(preview->wait(kSoon), 1) << preview->output();
  EXPECT_NE(preview->output().find("p.png: cannot be written (No space left on device)"),
            std::string::npos)
      << preview->output();
}

}  // namespace
}  // namespace hapticast::testing
