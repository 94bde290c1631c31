// SPDX-License-Identifier: MIT
// Both programs together: a virtual hand touches synthetic scenes and real clips; its log and
// summary.
#include <algorithm>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "client/haptics/safety/safety_state.hpp"
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

using Arguments = std::vector<std::string>;
using Summary = std::map<std::string, std::string>;

const Arguments kSummaryKeys = {"ticks",
                                "late_ticks",
                                "tick_ns.p50",
                                "tick_ns.p99",
                                "tick_ns.p999",
                                "tick_ns.max",
                                "frames.received",
                                "frames.lost",
                                "frames.late",
                                "frames.concealed",
                                "bytes_received",
                                "lookup.none",
                                "lookup.interpolated",
                                "lookup.extrapolated",
                                "lookup.held",
                                "lookup.faded",
                                "max_force_N",
                                "max_force_step_N",
                                "step_excess_max_N",
                                "contact_ticks",
                                "playout_delay_ms",
                                "clock_offset_us",
                                "clock_error_us",
                                "interferences.slew",
                                "interferences.peak",
                                "interferences.jump",
                                "realtime.fifo",
                                "realtime.mlock"};
// Ticks in which the device is pushed back: a third of a press.
constexpr std::size_t kEnoughContact = 500;
// As in messages.cpp: then the client warns that no frames arrive.
constexpr double kPatience_s = 3.0;

class ProgramsTouchTest : public ProgramsTest {
 protected:
  /// A client with log and summary of this name.
  std::unique_ptr<Process> touch(const std::string& name, const std::string& address,
                                 Arguments more) const {
    more.insert(more.end(), {address, "--log", path(name + ".csv"), "--summary",
                             path(name + ".json"), "--quiet"});
    return startClient(std::move(more));
  }
  [[nodiscard]] bool touchedEnough(const std::string& name) const {
    const auto rows = readLog(path(name + ".csv"));
    const auto pushed = std::count_if(rows.begin(), rows.end(), [](const LogRow& row) {
      return row.penetration_mm > 0.0 && row.force_N != Vec3::Zero();
    });
    return pushed >= static_cast<std::ptrdiff_t>(kEnoughContact);
  }
  [[nodiscard]] Summary summaryOf(const std::string& name) const {
    std::ifstream file(path(name + ".json"));
    const auto json = nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false);
    EXPECT_TRUE(json.is_object()) << name;
    if (!json.is_object()) return {};
    EXPECT_EQ(json.value("faults", nlohmann::json()), nlohmann::json::array());
    Summary out;
    for (const auto& [key, value] : json.items()) {
      if (!value.is_object()) out[key] = value.dump();
      if (!value.is_object()) continue;
      for (const auto& [inner, scalar] : value.items())
        out[std::string(key).append(".").append(inner)] = scalar.dump();
    }
    return out;
  }
  /// The log and the summary of a client that has ended.
  void check(const std::string& name, Process& server) const {
    SCOPED_TRACE(name);
    Summary summary = summaryOf(name);
    for (const std::string& key : kSummaryKeys) EXPECT_TRUE(summary.contains(key)) << key;
    const auto number = [&](const char* key) { return std::strtod(summary[key].c_str(), nullptr); };
    EXPECT_EQ(number("step_excess_max_N"), 0.0);
    EXPECT_EQ(number("frames.lost"), 0.0);
    const double contact = number("contact_ticks");
    EXPECT_GE(contact, static_cast<double>(kEnoughContact));
    const auto rows = readLog(path(name + ".csv"));
    EXPECT_EQ(static_cast<double>(rows.size()), number("ticks")) << "a row per tick";
    for (std::size_t i = 1; i < rows.size(); ++i) {
      ASSERT_GT(rows[i].t_s, rows[i - 1].t_s) << "row " << i;
    }
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows.front().t_s, 0.0) << "the first tick";
    EXPECT_EQ(rows.back().force_N, Vec3::Zero()) << "left with a force";

    // How much of it was interpolated is timing, so it is printed, not checked: a busy machine
    // skips frames and brings others late.
    std::cout << name << ": " << contact << " contact ticks, "
              << 100.0 * number("contact_lookup.interpolated") / contact << " % interpolated, "
              << number("max_force_N") << " N at most, " << number("late_ticks")
              << " late ticks, the server skipped " << skippedBy(server) << " frames\n";
  }
  /// With --quiet the client logs only warnings, and there is nothing to warn of. Where the log of
  /// the ticks shows that a starved machine delayed the frames, the client may say so.
  void expectNothingSaid(const std::string& name, const std::string& output) const {
    const auto rows = readLog(path(name + ".csv"));
    const bool held_up = std::any_of(rows.begin(), rows.end(),
                                     [](const LogRow& row) { return row.lookup == "faded"; });
    const bool began_late = std::any_of(rows.begin(), rows.end(), [](const LogRow& row) {
      return row.lookup == "none" && row.t_s > kPatience_s;
    });
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      const bool of_it = line.ends_with("no new frames arrive: the force has faded") ||
                         line.ends_with("frames arrive again") ||
                         line.find("later than the largest playout delay") != std::string::npos;
      const bool of_start = line.ends_with("no frames arrive: there is nothing to touch yet");
      // A surface that comes up under the hand.
      const bool of_depth = line.ends_with("no force until it leaves the object");
      const bool of_machine = line.ends_with(client::toText(client::SafetyState::kLateMachine));
      EXPECT_TRUE((held_up && of_it) || (began_late && of_start) || of_depth || of_machine) << line;
    }
  }
  /// All of `hands` on one server at once.
  void touchWith(const Arguments& hands, const Arguments& server_arguments,
                 const Arguments& client_arguments = {}) const {
    const auto server = startServer(server_arguments);
    const std::string address = addressOf(*server);
    std::vector<std::unique_ptr<Process>> clients;
    for (std::size_t i = 0; i < hands.size(); ++i) {
      Arguments arguments = client_arguments;
      arguments.insert(arguments.end(), {"--hand", hands[i]});
      clients.push_back(touch(std::to_string(i), address, arguments));
    }
    for (std::size_t i = 0; i < hands.size(); ++i) {
      EXPECT_TRUE(waitUntil(kSoon, [&] { return touchedEnough(std::to_string(i)); })) << hands[i];
    }
    for (std::size_t i = 0; i < hands.size(); ++i) {
      interrupt(*clients[i]);
      expectNothingSaid(std::to_string(i), clients[i]->output());
    }
    for (std::size_t i = 0; i < hands.size(); ++i) check(std::to_string(i), *server);
    interrupt(*server, SIGTERM);
  }

 private:
  /// Frames that the server has left out because it was too slow.
  static double skippedBy(const Process& server) {
    const std::string text = server.output();
    const std::string before = "frames/s: ";
    const std::size_t at = text.rfind(before);
    return at == std::string::npos ? 0.0 : std::strtod(text.c_str() + at + before.size(), nullptr);
  }
};

TEST_F(ProgramsTouchTest, EveryHandTouchesTheStillBall) {
  const std::string hand =
      write("hand.csv", "t_s,x_mm,y_mm,z_mm\n0,0,0,40\n0.5,0,0,21\n20,1,0,20\n600,0,0,20\n");
  touchWith({"press", "slide", "follow", hand}, {"--source", "synthetic:still", "--loop"});
}

TEST_F(ProgramsTouchTest, EveryHandTouchesTheBouncingBall) {
  // A hand that knows nothing of the ball waits where it comes by.
  const std::string hand = write("hand.csv", "0,-10,27,40\n1,-10,27,18\n");
  touchWith({"press", "slide", "follow", hand}, {"--source", "synthetic:bounce", "--loop"});
}

TEST_F(ProgramsTouchTest, LeavesAPictureOfTheTouch) {
  const std::string picture = path("picture.png");
  touchWith({"press"}, {"--source", "synthetic:still", "--loop"}, {"--screenshot", picture});
  const cv::Mat image = cv::imread(picture);
  ASSERT_FALSE(image.empty());
  EXPECT_GE(image.cols, 640);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(image, mean, deviation);
  EXPECT_GT(deviation[0], 5.0) << "a single colour";
}

TEST_F(ProgramsTouchTest, ThesisOnBothSides) {
  touchWith({"press"}, {"--source", "synthetic:bounce", "--loop", "--method", "thesis"},
            {"--method", "thesis"});
}

TEST_F(ProgramsTouchTest, AThesisClientReportsTheStagesThatAnotherServerDoes) {
  const auto server = startServer({"--source", makeClip("clip"), "--loop"});
  const auto client = startClient({addressOf(*server), "--method", "thesis"});
  EXPECT_TRUE(client->says("connected: ", kSoon)) << client->output();
  const std::string text = client->output();
  for (const char* stage : {"segmentation", "smoothing", "motion", "workspace"})
    EXPECT_NE(text.find(stage), std::string::npos) << text;
  interrupt(*client);
  const auto ours = startClient({addressOf(*server)});
  EXPECT_TRUE(ours->says("connected: ", kSoon)) << ours->output();
  EXPECT_EQ(countOccurrences("thesis", ours->output()), 0U) << ours->output();
  interrupt(*ours);
}

TEST_F(ProgramsTouchTest, TypingHandsOfThisRepositoryAreTouched) {
  const std::string clip = std::string(HAPTICAST_TESTS) + "/data/typing_hands";
  touchWith({"press"}, {"--source", clip, "--object", "167,111", "--loop"});
}

struct RealClip {
  const char* name;
  const char* object_px;
};
void PrintTo(const RealClip& clip, std::ostream* out) { *out << clip.name; }

class ProgramsRealClipTest : public ProgramsTouchTest,
                             public ::testing::WithParamInterface<RealClip> {};

TEST_P(ProgramsRealClipTest, IsTouched) {
  const std::string clip = std::string(HAPTICAST_CLIPS) + "/" + GetParam().name;
  if (!std::filesystem::exists(clip)) GTEST_SKIP() << clip << " is not here";
  touchWith({"press"}, {"--source", clip, "--object", GetParam().object_px, "--loop"});
}

INSTANTIATE_TEST_SUITE_P(Programs, ProgramsRealClipTest,
                         ::testing::Values(RealClip{"visp_rbt_desk", "505,330"},
                                           RealClip{"dkvfx_typing_person", "125,260"}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace hapticast::testing
