// SPDX-License-Identifier: MIT
// Answers of the programs to inputs that need files or a second program; wrong_inputs.txt has those
// of a command line alone.
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

using Arguments = std::vector<std::string>;
using Words = std::vector<std::string>;

class ProgramsInputTest : public ProgramsTest {
 protected:
  /// The server ends with this exit code and one line, which has these words in it.
  static void serverEnds(const Arguments& arguments, int exit_code, const Words& words) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const auto server = startServer(arguments);
    EXPECT_EQ(server->wait(kStart), exit_code);
    const std::string text = server->output();
    EXPECT_EQ(countOccurrences("\n", text), 1U) << text;
    for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << text;
  }
  void setDepth(const std::string& clip, int number, const cv::Mat& depth) const {
    cv::imwrite(clip + "/depth/" + std::to_string(number) + ".png", depth);
  }
};

TEST_F(ProgramsInputTest, AServerListensAtItsAddress) {
  const std::string clip = makeClip("clip");
  const std::vector<std::pair<std::string, std::string>> forms = {
      {":0", "[::]:"}, {"0", "[::]:"}, {"0.0.0.0:0", "0.0.0.0:"}, {"localhost:0", "localhost:"}};
  for (const auto& [given, expected] : forms) {
    const auto server = startServer({"--source", clip, "--loop"}, given);
    const std::string address = addressOf(*server);
    EXPECT_TRUE(address.starts_with(expected)) << address;
    const auto client = startClient({address.substr(address.rfind(':') + 1)});
    EXPECT_TRUE(client->says("connected: ", kSoon)) << client->output();
    interrupt(*client);
    interrupt(*server);
  }
}

TEST_F(ProgramsInputTest, AClientThatWaitsIsEndedBySignals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const auto client = startClient({"127.0.0.1:1"});
    ASSERT_TRUE(client->says("waiting for a server", kSoon)) << client->output();
    interrupt(*client, signal);
  }
}

TEST_F(ProgramsInputTest, ClipsThatDoNotFit) {
  const std::string clip = makeClip("object");
  std::filesystem::remove_all(clip + "/mask");
  cv::Mat hole(96, 128, CV_16UC1, cv::Scalar(0));
  cv::circle(hole, {60, 48}, 24, cv::Scalar(900), cv::FILLED);
  for (int i = 100; i < 106; ++i) setDepth(clip, i, hole);
  const std::vector<std::pair<Arguments, Words>> wrong = {
      {{"--source", path("")}, {"has no folder rgb/"}},
      {{"--source", clip, "--object", "128,3"}, {"--object 128,3", "128x96"}},
      {{"--source", clip, "--object", "3,3"}, {"--object 3,3", "there is no depth"}},
      {{"--source", clip, "--segment", "source"}, {"--segment source", "no mask"}}};
  for (const auto& [arguments, words] : wrong) serverEnds(arguments, 2, words);
}

TEST_F(ProgramsInputTest, AClipWithNothingToTouchIsReported) {
  const std::string clip = makeClip("clip");
  std::filesystem::remove_all(clip + "/mask");
  const auto warning = [&](const cv::Mat& depth) {
    for (int i = 100; i < 106; ++i) setDepth(clip, i, depth);
    const auto server = startServer({"--source", clip, "--frames", "2", "--quiet"});
    EXPECT_EQ(server->wait(kStart), 0) << server->output();
    EXPECT_EQ(countOccurrences("\n", server->output()), 1U) << server->output();
    return server->output();
  };
  cv::Mat depth = cv::Mat::zeros(96, 128, CV_16UC1);
  EXPECT_NE(warning(depth).find("depth is 0 in every pixel"), std::string::npos);
  depth.setTo(2000);
  depth.at<std::uint16_t>(90, 120) = 2001;
  EXPECT_NE(warning(depth).find("no object was found, so there is nothing to touch"),
            std::string::npos);
}

TEST_F(ProgramsInputTest, AServerThatSkipsFramesStillStartsEachRoundWithTheFirst) {
  const std::string clip = makeClip("clip", 8);
  std::filesystem::remove_all(clip + "/mask");
  for (int i = 100; i < 108; ++i) {  // the point named holds for the first only
    cv::Mat depth(96, 128, CV_16UC1, cv::Scalar(0));
    cv::circle(depth, {i == 100 ? 30 : 95, 48}, 16, cv::Scalar(900), cv::FILLED);
    setDepth(clip, i, depth);
  }
  const auto server = startServer({"--source", clip, "--object", "30,48", "--loop"});
  (void)addressOf(*server);
  // Stopped for some frames again and again, at any place of the clip: what is due is skipped. It
  // is stopped in seven of twelve turns of the wait.
  EXPECT_TRUE(waitUntil(kSoon, [&, turn = 0]() mutable {
    server->signal(++turn % 12 > 4 ? SIGSTOP : SIGCONT);
    return turn == 12 * 12 || !server->running();
  }));
  EXPECT_TRUE(server->running()) << server->output();
  EXPECT_TRUE(server->says("frames skipped", kSoon)) << server->output();
  interrupt(*server);
}

TEST_F(ProgramsInputTest, HelpAndVersionOfBoth) {
  for (const char* program : {HAPTICAST_SERVER_PROGRAM, HAPTICAST_CLIENT_PROGRAM}) {
    const auto help = start(program, {"--help-all"});
    EXPECT_EQ(help->wait(kSoon), 0);
    for (const char* flag : {"--method", "--config", "--quiet", "--version"})
      EXPECT_NE(help->output().find(flag), std::string::npos) << help->output();
    EXPECT_EQ(start(program, {"--version"})->wait(kSoon), 0);
  }
}

}  // namespace
}  // namespace hapticast::testing
