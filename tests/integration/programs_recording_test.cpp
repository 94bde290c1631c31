// SPDX-License-Identifier: MIT
// The server records its stream and plays the recording; a client touches what it plays, an
// operator changes it, and a script that shares no code reads it.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <variant>

#include "common/playback/stream_reader.hpp"
#include "tests/integration/frame_counter.hpp"
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsRecordingTest : public ProgramsTest {
 protected:
  /// Returns the recording of the bouncing ball.
  [[nodiscard]] std::string record(const std::string& name, int frames) const {
    const auto server = startServer({"--source", "synthetic:bounce", "--map-range", "520,620",
                                     "--frames", std::to_string(frames), "--record", path(name)});
    EXPECT_EQ(server->wait(kStart), 0) << server->output();
    EXPECT_NE(server->output().find(path(name) + " is complete"), std::string::npos)
        << server->output();
    return path(name);
  }
  /// Starts a client whose hand presses, with a log.
  [[nodiscard]] std::unique_ptr<Process> press(const std::string& address,
                                               const std::vector<std::string>& more) const {
    std::filesystem::remove(path("log.csv"));
    std::vector<std::string> arguments{address,  "--device", "virtual", "--hand",       "press",
                                       "--view", "off",      "--log",   path("log.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return startClient(std::move(arguments));
  }
  /// Ends it after so many ticks with a force.
  void endAfter(std::ptrdiff_t touched, Process& client) const {
    EXPECT_TRUE(touchesFor(touched)) << client.output();
    interrupt(client);
  }
  [[nodiscard]] nlohmann::json readSummary(const std::string& name) const {
    std::ifstream in(path(name));
    return nlohmann::json::parse(in);
  }
  [[nodiscard]] nlohmann::json touch(const std::string& address, const std::string& name) const {
    const auto client = press(address, {"--summary", path(name)});
    endAfter(500, *client);
    return readSummary(name);
  }
  /// Records a client that touches a server's ball. Returns the number of its ticks.
  [[nodiscard]] std::size_t recordRun(const std::string& name) const {
    const auto server = startServer({"--source", "synthetic:bounce", "--loop"});
    const auto client = press(addressOf(*server), {"--record", path(name)});
    endAfter(1000, *client);
    interrupt(*server);
    return readLog(path("log.csv")).size();
  }
};

TEST_F(ProgramsRecordingTest, ARecordingIsTouchedAsItsStreamWas) {
  const std::string file = record("bounce.mcap", 100);
  const auto server = startServer({"--source", file, "--loop"});
  const auto summary = touch(addressOf(*server), "summary.json");
  EXPECT_GT(summary.at("contact_ticks"), 500);
  EXPECT_LT(summary.at("max_force_N"), 3.31);
  interrupt(*server);
}

TEST_F(ProgramsRecordingTest, ARecordingRefusesFlagsOfVision) {
  const std::string file = record("short.mcap", 5);
  const auto server = startServer({"--source", file, "--object", "3,4"});
  EXPECT_EQ(server->wait(kSoon), 2);
  EXPECT_NE(server->output().find("--object: a recording has its frames already; give this flag to "
                                  "the server that records"),
            std::string::npos)
      << server->output();
}

TEST_F(ProgramsRecordingTest, AnOperatorChangesThePlayback) {
  const std::string file = record("bounce.mcap", 100);
  // SHA-256 of the token.
  const std::string tokens =
      write("tokens",
            "0969a26e38d3babd0585d3aab24b4d3dbeb4a48b247ce18c50c3000f382fd213 operator never\n");
  std::filesystem::permissions(tokens, std::filesystem::perms::owner_read);
  const std::string token = write("token", "token of the operator\n");
  std::filesystem::permissions(token, std::filesystem::perms::owner_read);
  const auto server = startServer({"--source", file, "--loop", "--tokens", tokens});
  const std::string address = addressOf(*server);
  const std::vector<std::pair<std::string, std::string>> requests{
      {"pause", "an operator pauses the stream"},
      {"seek=2,speed=0.5,play", "an operator seeks to 2 s"},
      {"speed=2,stiffness=0.2", "an operator sets the speed to 2"}};
  for (const auto& [request, line] : requests) {
    const auto operator_program =
        startClient({address, "--token-file", token, "--control", request});
    EXPECT_EQ(operator_program->wait(kSoon), 0) << operator_program->output();
    EXPECT_TRUE(server->says(line, kSoon)) << server->output();
  }
  const auto viewer = press(address, {"--token-file", token});
  endAfter(100, *viewer);
  interrupt(*server);
}

TEST_F(ProgramsRecordingTest, ARunIsRenderedAgainWithTheSameBits) {
  const std::size_t ticks = recordRun("run.mcap");
  const auto replay = startClient({"--replay", path("run.mcap"), "--log", path("run.csv")});
  EXPECT_EQ(replay->wait(kSoon), 0) << replay->output();
  EXPECT_NE(replay->output().find("all forces have the recorded bits"), std::string::npos)
      << replay->output();
  EXPECT_GT(readLog(path("run.csv")).size(), ticks / 2) << "all but those of the start";
  const auto soft = startClient({"--replay", path("run.mcap"), "--stiffness", "0.1"});
  EXPECT_EQ(soft->wait(kSoon), 0) << soft->output();
  EXPECT_NE(soft->output().find("forces differ from the recorded ones"), std::string::npos)
      << soft->output();
}

TEST_F(ProgramsRecordingTest, ASignalEndsAReplayWithItsFilesComplete) {
  const std::size_t ticks = recordRun("run.mcap");
  // The replay waits for the reader of its log, so that the signal comes before its end.
  const std::string log = path("pipe.csv");
  ASSERT_EQ(::mkfifo(log.c_str(), 0600), 0);
  const int reader = ::open(log.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const auto replay =
      startClient({"--replay", path("run.mcap"), "--log", log, "--record", path("part.mcap")});
  std::string rows;
  std::array<char, 4096> bytes{};
  const auto read = [&] {
    const ssize_t count = ::read(reader, bytes.data(), bytes.size());
    if (count > 0) rows.append(bytes.data(), static_cast<std::size_t>(count));
    return count > 0;
  };
  EXPECT_TRUE(waitUntil(kSoon, read)) << replay->output();
  replay->signal(SIGTERM);
  EXPECT_TRUE(waitUntil(kSoon, [&] {
    while (read()) {
    }
    return !replay->running();
  })) << replay->output();
  while (read()) {
  }
  ::close(reader);
  EXPECT_EQ(replay->wait(kSoon), 0) << replay->output();
  EXPECT_EQ(rows.back(), '\n') << "a complete row";
  EXPECT_LT(countOccurrences("\n", rows), ticks / 2);
  const auto part = startClient({"--replay", path("part.mcap")});
  EXPECT_EQ(part->wait(kSoon), 0) << part->output();
  EXPECT_NE(part->output().find("all forces have the recorded bits"), std::string::npos)
      << part->output();
}

TEST_F(ProgramsRecordingTest, AScriptReadsTheRecording) {
  if (!std::filesystem::exists(HAPTICAST_PYTHON)) GTEST_SKIP() << "no Python";
  const std::string file = record("bounce.mcap", 60);
  std::size_t frames = 0, pictures = 0;  // a slow server leaves frames out
  auto reader = StreamReader::open(file);
  ASSERT_TRUE(reader.ok());
  while (const auto item = reader.value().next()) {
    frames += std::holds_alternative<CodedFrame>(*item) ? 1U : 0U;
    pictures += std::holds_alternative<VideoFrame>(*item) ? 1U : 0U;
  }
  ASSERT_GT(pictures, 0U);
  Process script({HAPTICAST_PYTHON, std::string(HAPTICAST_EXAMPLES) + "/read_recording.py", file,
                  "--pictures", path("pictures")});
  const auto exit_code = script.wait(kSoon);
  if (exit_code == 77) GTEST_SKIP() << script.output();
  ASSERT_EQ(exit_code, 0) << script.output();
  const std::string count = std::to_string(frames);
  EXPECT_NE(script.output().find("/frame: " + count + " messages"), std::string::npos)
      << script.output();
  EXPECT_NE(script.output().find("object 1: " + count + " frames"), std::string::npos)
      << script.output();
  std::string last = "000000" + std::to_string(pictures - 1);
  last.erase(0, last.size() - 6);
  const cv::Mat picture = cv::imread(path("pictures/" + last + ".jpg"));
  EXPECT_EQ(picture.size(), cv::Size(640, 480));
}

TEST_F(ProgramsRecordingTest, AKilledServerLeavesARecordingThatPlays) {
  const auto server = startServer({"--source", "synthetic:bounce", "--map-range", "520,620",
                                   "--loop", "--http", "127.0.0.1:0", "--record", path("a.mcap")});
  ASSERT_TRUE(server->says("streaming synthetic:bounce", kStart)) << server->output();
  EXPECT_TRUE(
      waitUntil(kSoon, [&] { return std::filesystem::file_size(path("a.mcap")) >= 1'000'000; }));
  server->signal(SIGKILL);
  (void)server->wait(kSoon);
  const auto player = startServer({"--source", path("a.mcap"), "--frames", "10"});
  EXPECT_EQ(player->wait(kStart), 0) << player->output();
  const auto whole = startServer({"--source", path("a.mcap")});
  EXPECT_EQ(whole->wait(kSoon), 0) << whole->output();
  EXPECT_NE(whole->output().find("a.mcap is cut off: it plays for "), std::string::npos)
      << whole->output();
}

TEST_F(ProgramsRecordingTest, AFullDiskLosesMessagesAndDelaysNothing) {
  // The shell's limit of a file's size (512-byte blocks) is a disk of 1 MB.
  Process server({"/bin/sh", "-c", "ulimit -f 2000; exec \"$@\"", "sh", HAPTICAST_SERVER_PROGRAM,
                  "--source", "synthetic:bounce", "--loop", "--map-range", "520,620", "--listen",
                  "127.0.0.1:0", "--record", path("full.mcap")});
  const std::string address = addressOf(server);
  const auto client = press(address, {"--summary", path("summary.json")});
  EXPECT_TRUE(server.says("messages are lost (File too large)", kSoon)) << server.output();
  EXPECT_TRUE(deliversFrames(address, 60)) << "the stream goes on: " << server.output();
  endAfter(500, *client);
  const auto summary = readSummary("summary.json");
  EXPECT_GT(summary.at("frames").at("received"), 0);
  EXPECT_EQ(summary.at("frames").at("lost"), 0);
  interrupt(server);
  EXPECT_NE(server.output().find("full.mcap lacks"), std::string::npos) << server.output();
  EXPECT_LE(std::filesystem::file_size(path("full.mcap")), 2000U * 512U);
  // What was written plays.
  const auto player = startServer({"--source", path("full.mcap"), "--frames", "5"});
  EXPECT_EQ(player->wait(kStart), 0) << player->output();
}

TEST_F(ProgramsRecordingTest, AReplayWritesFilmPictureAndRecording) {
  (void)recordRun("run.mcap");
  const auto replay = startClient({"--replay", path("run.mcap"), "--stiffness", "0.2", "--record",
                                   path("soft.mcap"), "--film", path("film.mp4"), "--screenshot",
                                   path("touch.png")});
  EXPECT_EQ(replay->wait(kSoon), 0) << replay->output();
  EXPECT_GT(std::filesystem::file_size(path("film.mp4")), 20'000U);
  EXPECT_GT(std::filesystem::file_size(path("touch.png")), 20'000U);
  const auto again = startClient({"--replay", path("soft.mcap")});
  EXPECT_EQ(again->wait(kSoon), 0) << again->output();
  EXPECT_NE(again->output().find("all forces have the recorded bits"), std::string::npos)
      << again->output();
}

TEST_F(ProgramsRecordingTest, AViewerSeesARecordingOnDemandFromItsBegin) {
  const std::string file = record("bounce.mcap", 100);
  const auto server = startServer({"--source", file, "--on-demand", "--loop"});
  for (const char* const name : {"first.json", "second.json"})
    EXPECT_GT(touch(addressOf(*server), name).at("contact_ticks"), 500);
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
