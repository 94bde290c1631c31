// SPDX-License-Identifier: MIT
// Both programs with depth from a child that dies, hangs, floods and answers wrongly while a hand
// presses the object. The force fades, and comes back without a step.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

using ::testing::HasSubstr;

constexpr double kMostEnergy_J = 0.01;

/// Depth of the disc of makeClip(): near where the picture is bright. Before an answer the child
/// does once what the file `mode` says.
constexpr const char* kChild = R"(
import array, os, signal, sys
mode = sys.argv[1]
with open(mode + ".pid", "w") as out:
    out.write(str(os.getpid()))
while sys.stdin.buffer.readline():
    width, height = map(int, sys.stdin.buffer.readline().split())
    sys.stdin.buffer.readline()
    red = sys.stdin.buffer.read(3 * width * height)[::3]
    depth = array.array("f", [900.0 if value > 150 else 2000.0 for value in red])
    kind = "metric_mm"
    if os.path.exists(mode):
        with open(mode) as text:
            what = text.read()
        os.remove(mode)
        if what == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        if what == "stop":
            os.kill(os.getpid(), signal.SIGSTOP)
        if what == "flood":
            while True:
                sys.stdout.buffer.write(b"no depth\n" * 10000)
        if what == "wrong":
            width, depth = 1, depth[:height]
    sys.stdout.buffer.write(f"{width} {height} {kind}\n".encode() + depth.tobytes())
    sys.stdout.buffer.flush()
)";

class ProgramsChildTest : public ProgramsTest {
 protected:
  /// Returns the work of the force into the hand over the whole log, J. Rows are of each tick or,
  /// on a busy machine, of most.
  [[nodiscard]] double computeWork() const {
    const std::vector<LogRow> rows = readLog(path("log.csv"));
    double work_mJ = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i)
      work_mJ += rows[i].force_N.dot(rows[i].hip_mm - rows[i - 1].hip_mm);
    return 1e-3 * work_mJ;
  }
  /// Makes the child misbehave and waits until its line is in the log for the `times`th time.
  void misbehave(Process& server, const std::string& what, const char* line, std::size_t times) {
    write("mode.new", what);
    std::filesystem::rename(path("mode.new"), path("mode"));
    EXPECT_TRUE(server.says(line, kSoon, times)) << what << server.output();
    if (what != "stop") return;
    EXPECT_TRUE(forceIs(false));
    std::ifstream in(path("mode.pid"));
    pid_t child = 0;
    in >> child;
    ASSERT_GT(child, 1);
    ::kill(child, SIGCONT);
  }
};

TEST_F(ProgramsChildTest, NoChildPutsAStepIntoAPressingHand) {
  const char* const more = std::getenv("HAPTICAST_CHILD_ROUNDS");  // 5: twenty times in all
  const int rounds = more != nullptr ? std::atoi(more) : 1;
  const std::string clip = makeClip("clip");
  std::filesystem::remove_all(clip + "/depth");
  for (const char* part : {"rgb/", "mask/"}) {  // a disc at rest
    for (int i = 101; i < 106; ++i)
      std::filesystem::copy_file(path("clip/") + part + "100.png",
                                 path("clip/") + part + std::to_string(i) + ".png",
                                 std::filesystem::copy_options::overwrite_existing);
  }
  const auto server = startServer(
      {"--source", clip, "--loop", "--depth-from",
       "/usr/bin/env python3 '" + write("child.py", kChild) + "' '" + path("mode") + "'"});
  const std::string address = addressOf(*server);
  ASSERT_FALSE(address.empty()) << server->output();
  const auto client = startClient(
      {address, "--hand", "follow", "--log", path("log.csv"), "--summary", path("summary.json")});
  ASSERT_TRUE(forceIs(true)) << client->output() << server->output();
  std::size_t gaps = 0;
  const auto isBack = [&] {
    EXPECT_TRUE(server->says(" answers are back after ", kSoon, ++gaps)) << server->output();
    EXPECT_TRUE(forceIs(true)) << server->output();
  };
  for (int round = 1; round <= rounds; ++round) {
    const auto times = static_cast<std::size_t>(round);
    misbehave(*server, "die", "ended with signal 9 (Killed); the server starts it again", times);
    isBack();
    misbehave(*server, "stop", "no answer for 1 s", times);
    isBack();
    misbehave(*server, "flood", "writes 'no depth', which is no header", times);
    isBack();
    // A clip's frame with the wrong size is left out. The log names each frame once.
    misbehave(*server, "wrong", "which has another shape", round == 1 ? 1 : 0);
    EXPECT_TRUE(forceIs(true)) << server->output();
  }
  interrupt(*client);
  std::ifstream in(path("summary.json"));
  const auto summary = nlohmann::json::parse(in);
  EXPECT_EQ(summary["step_excess_max_N"], 0.0) << summary;
  const double work_J = computeWork();
  EXPECT_LE(work_J, kMostEnergy_J);
  std::printf("%d gaps, work into the hand %.2f mJ\n", 4 * rounds, 1e3 * work_J);
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
