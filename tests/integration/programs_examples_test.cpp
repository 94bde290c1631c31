// SPDX-License-Identifier: MIT
// proto/examples/read_stream.py, which shares no code with the client, against the real server:
// what comes by TCP and what comes in signed datagrams is the same relief.
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsExamplesTest : public ProgramsTest {
 protected:
  /// Lets the script take some frames and returns its exit code; the reliefs are in `out`.
  int readStream(const std::string& address, const std::string& out,
                 std::vector<std::string> flags) const {
    std::vector<std::string> command{HAPTICAST_PYTHON,
                                     std::string(HAPTICAST_EXAMPLES) + "/read_stream.py",
                                     address,
                                     "--frames",
                                     "30",
                                     "--out",
                                     path(out)};
    command.insert(command.end(), flags.begin(), flags.end());
    Process script(std::move(command));
    const auto exit_code = script.wait(kSoon);
    said = script.output();
    return exit_code.value_or(-1);
  }

  mutable std::string said;
};

TEST_F(ProgramsExamplesTest, AForeignClientReadsTheStreamByTcpAndByDatagrams) {
  if (!std::filesystem::exists(HAPTICAST_PYTHON)) GTEST_SKIP() << "no Python";
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  const int tcp = readStream(address, "tcp", {});
  if (tcp == 77) GTEST_SKIP() << said;
  ASSERT_EQ(tcp, 0) << said;
  const cv::Mat relief = cv::imread(path("tcp/object_1_0.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(relief.type(), CV_16UC1);
  EXPECT_EQ(relief.size(), cv::Size(640, 480));
  double highest = 0.0;
  cv::minMaxLoc(relief, nullptr, &highest);
  EXPECT_GT(cv::countNonZero(relief), 5000) << said;
  EXPECT_LE(highest, 30000.0) << "thousandths of a mm";
  EXPECT_GT(highest, 10000.0);
  const int udp = readStream(address, "udp", {"--udp"});
  if (udp == 77) GTEST_SKIP() << said;
  ASSERT_EQ(udp, 0) << said;
  EXPECT_NE(said.find(" 0 refused"), std::string::npos) << said;
  const cv::Mat same = cv::imread(path("udp/object_1_0.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(same.size(), relief.size());
  EXPECT_EQ(cv::countNonZero(same != relief), 0) << "a still scene, another transport";
  interrupt(*server);
}

TEST_F(ProgramsExamplesTest, AForeignClientUsesTlsAndOpensSealedDatagrams) {
  if (!std::filesystem::exists(HAPTICAST_PYTHON)) GTEST_SKIP() << "no Python";
  const auto server = startStillServer({"--tls", "auto"});
  const std::string address = addressOf(*server);
  const std::string log = server->output();
  const std::string fingerprint = log.substr(log.find("TLS fingerprint: ") + 17, 64);
  const int plain = readStream(address, "plain", {"--udp"});
  if (plain == 77) GTEST_SKIP() << said;
  EXPECT_EQ(plain, 1) << "a viewer without TLS gets no datagrams that it could not open";
  const int sealed = readStream(address, "udp", {"--udp", "--tls", "--fingerprint", fingerprint});
  ASSERT_EQ(sealed, 0) << said;
  EXPECT_NE(said.find(" 0 refused"), std::string::npos) << said;
  EXPECT_EQ(readStream(address, "udp", {"--tls", "--fingerprint", std::string(64, '0')}), 1);
  EXPECT_NE(said.find("another fingerprint"), std::string::npos) << said;
  const cv::Mat relief = cv::imread(path("udp/object_1_0.png"), cv::IMREAD_UNCHANGED);
  EXPECT_GT(cv::countNonZero(relief), 5000) << said;
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
