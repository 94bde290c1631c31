// SPDX-License-Identifier: MIT
// Outputs that cannot be written: a log whose reader has ended, and a full disk.
#include <nlohmann/json.hpp>

#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsOutputsTest : public ProgramsTest {
 protected:
  /// Mounts a disk of `size`. Returns false where that needs rights.
  [[nodiscard]] bool mountSmallDisk(const std::string& size = "4k") {
    std::filesystem::create_directories(path("disk"));
    mounted_ =
        std::system(("mount -t tmpfs -o size=" + size + " tmpfs '" + path("disk") + "' 2>/dev/null")
                        .c_str()) == 0;
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
  /// Starts a subcommand with these outputs besides its own.
  static std::unique_ptr<Process> startWith(std::vector<std::string> command,
                                            const std::vector<std::string>& outputs) {
    command.insert(command.end(), outputs.begin(), outputs.end());
    return startClient(std::move(command));
  }
  /// Returns the command of touch, whose hand presses for 2 s.
  static std::vector<std::string> touch(const std::string& address) {
    return {address, "--device", "virtual", "--hand", "press", "--view", "off", "--seconds", "2"};
  }
  /// Returns the command of a study with one trial of 2 s.
  [[nodiscard]] std::vector<std::string> study() const {
    auto command = makeStudy(R"([{"name": "one"}])");
    command.insert(command.end(), {"--device", "virtual"});
    return command;
  }
  /// Expects that the client fails, with one line for each of these flags and nothing else.
  static void expectLines(Process& client, const std::vector<std::string>& flags) {
    EXPECT_EQ(client.wait(kSoon), 1);
    const std::string text = client.output();
    for (const std::string& flag : flags)
      EXPECT_EQ(countOccurrences(" error " + flag + ": ", text), 1U) << text;
    EXPECT_EQ(countOccurrences(" error ", text), flags.size()) << text;
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

TEST_F(ProgramsOutputsTest, AFullDiskLeavesTheOtherFilesOfTouchStudyAndReplayComplete) {
  const auto server = startStillServer();
  const std::string log = path("full.csv");
  const std::string film = path("full.mp4");
  std::filesystem::create_symlink("/dev/full", log);
  std::filesystem::create_symlink("/dev/full", film);
  const std::vector<std::string> full = {"--log", log, "--film", film};
  const auto expectFull = [&](Process& client) {
    expectLines(client, {"--log " + log, "--film " + film});
  };
  auto command = touch(addressOf(*server));
  command.insert(command.end(), {"--record", path("run.mcap"), "--summary", path("run.json")});
  const auto touched = startWith(command, full);
  expectFull(*touched);
  EXPECT_TRUE(touched->says("run.mcap is complete", kSoon)) << touched->output();
  EXPECT_GT(nlohmann::json::parse(std::ifstream(path("run.json")))["ticks"], 1000);
  const auto studied = startWith(study(), full);
  expectFull(*studied);
  EXPECT_TRUE(studied->says("_run-1.mcap is complete", kSoon)) << studied->output();
  EXPECT_TRUE(std::filesystem::exists(path("out/participants.tsv")));
  const auto replayed =
      startWith({"replay", path("run.mcap"), "--record", path("again.mcap")}, full);
  expectFull(*replayed);
  const auto again = startClient({"replay", path("again.mcap")});
  EXPECT_EQ(again->wait(kSoon), 0) << "the recording is complete: " << again->output();
  interrupt(*server);
}

TEST_F(ProgramsOutputsTest, ARecordingWithoutSpaceFailsTouchStudyAndReplay) {
  if (!mountSmallDisk("256k")) GTEST_SKIP() << "only root can mount a small disk";
  const auto server = startStillServer();
  const std::string file = path("disk/run.mcap");
  const auto expectFull = [&](Process& client, const std::string& recording) {
    expectLines(client, {"--record " + recording});
    std::filesystem::remove(recording);
  };
  const std::string address = addressOf(*server);
  const auto touched = startWith(touch(address), {"--record", file, "--summary", path("run.json")});
  expectFull(*touched, file);
  EXPECT_GT(nlohmann::json::parse(std::ifstream(path("run.json")))["ticks"], 1000);
  std::filesystem::create_directories(path("out/sourcedata"));
  std::filesystem::create_directory_symlink(path("disk"), path("out/sourcedata/sub-1"));
  const auto studied = startWith(study(), {"--log", path("study.csv")});
  expectFull(*studied, path("out/sourcedata/sub-1/sub-1_task-still_run-1.mcap"));
  EXPECT_GT(readLog(path("study.csv")).size(), 1000U);
  const auto whole = startWith(touch(address), {"--record", path("whole.mcap")});
  ASSERT_EQ(whole->wait(kSoon), 0) << whole->output();
  const auto replayed =
      startWith({"replay", path("whole.mcap")}, {"--record", file, "--log", path("replay.csv")});
  expectFull(*replayed, file);
  EXPECT_GT(readLog(path("replay.csv")).size(), 1000U);
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
