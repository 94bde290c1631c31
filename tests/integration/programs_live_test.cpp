// SPDX-License-Identifier: MIT
// Both programs with a live stream of another program: the stream stalls, its sender dies and comes
// back. A viewer's force fades, and comes back without a step.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/programs_fixture.hpp"
#include "tests/support/installed.hpp"
#include "tests/support/own_network.hpp"

namespace hapticast::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A way from a sender to the server.
struct Way {
  const char* name;
  const char* sent_to;     ///< with PORT; the file for an RTSP sender
  const char* read_from;   ///< with PORT
  const char* port_table;  ///< of the kernel, where the sender's port appears
};
constexpr Way kSrt{"Srt", "srt://127.0.0.1:PORT?mode=listener",
                   "srt://127.0.0.1:PORT?passphrase_of_none=secret", "/proc/net/udp"};
constexpr Way kHttp{"Http", "http://127.0.0.1:PORT/cam",
                    "http://me:secret@127.0.0.1:PORT/cam?token=secret", "/proc/net/tcp"};
constexpr Way kRtsp{"Rtsp", "", "rtsp://127.0.0.1:PORT/cam", "/proc/net/tcp"};

/// Of the senders, which need a number, in a network of the test's own.
constexpr std::uint16_t kPort = 7470;

std::string withPort(std::string text) {
  return text.replace(text.find("PORT"), 4, std::to_string(kPort));
}

/// Returns whether `table` of the kernel has a socket that waits at `port`.
bool isOpen(const char* table, std::uint16_t port) {
  std::array<char, 8> wanted{};
  std::snprintf(wanted.data(), wanted.size(), ":%04X", port);
  std::ifstream in(table);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string slot, local, remote, state;
    words >> slot >> local >> remote >> state;
    if (local.ends_with(wanted.data()) && (state == "0A" || state == "07")) return true;
  }
  return false;
}

class ProgramsLiveTest : public ProgramsTest {
 protected:
  void SetUp() override {
    if (!isInstalled("ffmpeg")) GTEST_SKIP() << "needs ffmpeg";
    if (!enterOwnNetwork()) GTEST_SKIP() << "network namespaces are not allowed here";
    drawVideo();
  }
  /// A near ball on a far wall, beside its depth: two minutes of H.264.
  void drawVideo() const {
    cv::Mat picture(96, 256, CV_8UC3, cv::Scalar(60, 60, 60));
    cv::circle(picture, {64, 48}, 30, {40, 160, 220}, cv::FILLED);
    picture.colRange(128, 256).setTo(cv::Scalar::all(40));
    for (int r = 30; r > 0; --r)
      cv::circle(picture, {192, 48}, r, cv::Scalar::all(220 - 2 * r), cv::FILLED);
    cv::imwrite(path("picture.png"), picture);
    const std::string command = "cd '" + path("") +
                                "' && ffmpeg -loglevel quiet -loop 1 -framerate 25 -i picture.png "
                                "-t 120 -c:v libx264 -preset ultrafast -tune zerolatency -crf 10 "
                                "-g 25 -pix_fmt yuv420p video.mp4 </dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  /// Starts the sender, and waits until it can be reached.
  [[nodiscard]] std::unique_ptr<Process> send(const Way& way) const {
    auto sender = std::make_unique<Process>(sendCommand(way));
    EXPECT_TRUE(waitUntil(kSoon, [&] { return isOpen(way.port_table, kPort); }))
        << sender->output();
    return sender;
  }
  [[nodiscard]] std::vector<std::string> sendCommand(const Way& way) const {
#ifdef HAPTICAST_RTSP_SENDER
    if (*way.sent_to == 0) return {HAPTICAST_RTSP_SENDER, path("video.mp4"), std::to_string(kPort)};
#endif
    std::vector<std::string> command{"/usr/bin/env", "ffmpeg", "-loglevel",       "error",
                                     "-re",          "-i",     path("video.mp4"), "-c",
                                     "copy",         "-f",     "mpegts"};
    if (std::string(way.sent_to).starts_with("http"))
      command.insert(command.end(), {"-listen", "1"});
    command.push_back(withPort(way.sent_to));
    return command;
  }
  /// Touches the stream while `disturb` stops its sender and `mend` mends it.
  void touchThrough(const Way& way, const std::function<void(std::unique_ptr<Process>&)>& disturb,
                    const std::function<void(std::unique_ptr<Process>&)>& mend) {
    auto sender = send(way);
    const auto server = startServer(
        {"--source", withPort(way.read_from), "--layout", "side-by-side", "--object", "64,48"});
    const std::string address = addressOf(*server);
    ASSERT_FALSE(address.empty()) << server->output() << sender->output();
    const auto client = startClient(
        {address, "--hand", "follow", "--log", path("log.csv"), "--summary", path("summary.json")});
    ASSERT_TRUE(forceIs(true)) << client->output() << server->output();
    disturb(sender);
    EXPECT_TRUE(server->says("no frames from ", kSoon)) << server->output();
    EXPECT_TRUE(forceIs(false)) << client->output();
    mend(sender);
    EXPECT_TRUE(server->says(" are back after ", kSoon)) << server->output();
    EXPECT_TRUE(forceIs(true)) << client->output() << server->output();
    interrupt(*client);
    std::ifstream in(path("summary.json"));
    const auto summary = nlohmann::json::parse(in);
    EXPECT_EQ(summary["step_excess_max_N"], 0.0) << summary;
    sender.reset();
    interrupt(*server);
    EXPECT_THAT(server->output() + client->output(), Not(HasSubstr("secret")));
  }
};

TEST_F(ProgramsLiveTest, AStalledSrtStreamComesBack) {
  touchThrough(
      kSrt, [](auto& sender) { sender->signal(SIGSTOP); },
      [](auto& sender) { sender->signal(SIGCONT); });
}

TEST_F(ProgramsLiveTest, AnHttpSenderThatDiesComesBack) {
  touchThrough(
      kHttp, [](auto& sender) { sender.reset(); }, [this](auto& sender) { sender = send(kHttp); });
}

TEST_F(ProgramsLiveTest, AnRtspSenderThatDiesComesBack) {
#ifndef HAPTICAST_RTSP_SENDER
  GTEST_SKIP() << "needs libgstrtspserver-1.0-dev";
#endif
  touchThrough(
      kRtsp, [](auto& sender) { sender.reset(); }, [this](auto& sender) { sender = send(kRtsp); });
}

}  // namespace
}  // namespace hapticast::testing
