// SPDX-License-Identifier: MIT
// The server bakes a clip into a recording, which plays. An interrupted bake continues, and ends in
// the same bytes.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/page/page_files.hpp"
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsBakeTest : public ProgramsTest {
 protected:
  [[nodiscard]] std::unique_ptr<Process> startBake(const std::string& name,
                                                   std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"bake", "synthetic:bounce", "--fps", "50", "-o", path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start(HAPTICAST_SERVER_PROGRAM, std::move(arguments));
  }
  [[nodiscard]] std::uintmax_t sizeOf(const std::string& name) const {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path(name), error);
    return error ? 0 : size;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(ProgramsBakeTest, ABakedClipPlays) {
  const auto bake = startBake("bounce.mcap", {"--frames", "100"});
  EXPECT_EQ(bake->wait(kStart), 0) << bake->output();
  EXPECT_TRUE(bake->says("bounce.mcap is complete", kSoon)) << bake->output();
  EXPECT_FALSE(std::filesystem::exists(path("bounce.mcap.part")));
  const auto server = startServer({"--source", path("bounce.mcap"), "--loop"});
  const auto client = startClient({addressOf(*server), "--device", "virtual", "--hand", "press",
                                   "--view", "off", "--log", path("log.csv")});
  EXPECT_TRUE(touchesFor(500)) << client->output();
  interrupt(*client);
  interrupt(*server);
}

TEST_F(ProgramsBakeTest, AFolderHasThePageBesideTheRecording) {
  if (!server::isPageComplete()) GTEST_SKIP() << "this build has no page";
  const auto bake = startBake("touch/", {"--frames", "25", "--picture-quality", "15"});
  EXPECT_EQ(bake->wait(kStart), 0) << bake->output();
  EXPECT_TRUE(bake->says("touch/ is complete", kSoon)) << bake->output();
  EXPECT_NE(read("touch/index.html").find("content=\"recording.mcap\""), std::string::npos);
  EXPECT_EQ(read("touch/core.wasm").substr(0, 4), std::string("\0asm", 4));
  EXPECT_GT(sizeOf("touch/recording.mcap"), 100'000U);
  std::uintmax_t all = 0;
  for (const auto& file : std::filesystem::directory_iterator(path("touch")))
    all += file.file_size();
  EXPECT_LT(all, 1'050'000U) << "as the demo leaves it";
}

TEST_F(ProgramsBakeTest, AnInterruptedBakeEndsInTheSameBytes) {
  const auto whole = startBake("whole.mcap");
  EXPECT_EQ(whole->wait(kStart), 0) << whole->output();
  const std::string bytes = read("whole.mcap");
  // Killed in the middle of its work, then ended by Ctrl-C, then left alone.
  for (const auto& [number, share] : {std::pair{SIGKILL, 0.3}, std::pair{SIGINT, 0.6}}) {
    const auto bake = startBake("parts.mcap", {"--resume"});
    ASSERT_TRUE(waitUntil(kStart, [&, share = share] {
      return double(sizeOf("parts.mcap.part")) > share * double(bytes.size()) || !bake->running();
    }));
    ASSERT_TRUE(bake->running()) << bake->output();
    bake->signal(number);
    (void)bake->wait(kSoon);
    ASSERT_FALSE(std::filesystem::exists(path("parts.mcap"))) << bake->output();
  }
  const auto refused = startBake("parts.mcap");
  EXPECT_EQ(refused->wait(kStart), 2) << refused->output();
  EXPECT_TRUE(refused->says("continue it with --resume", kSoon)) << refused->output();
  const auto other = startBake("parts.mcap", {"--resume", "--mass", "2"});
  EXPECT_EQ(other->wait(kStart), 2) << other->output();
  const auto last = startBake("parts.mcap", {"--resume"});
  EXPECT_EQ(last->wait(kStart), 0) << last->output();
  EXPECT_TRUE(last->says("continues after ", kSoon)) << last->output();
  EXPECT_TRUE(read("parts.mcap") == bytes)
      << "sizes " << sizeOf("parts.mcap") << ", " << bytes.size();
}

}  // namespace
}  // namespace hapticast::testing
