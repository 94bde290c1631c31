// SPDX-License-Identifier: MIT
// A gamepad as a person uses it, on SDL's own made-up pad: a real server streams a ball, the sticks
// lead the tip to it, its motors render the touch. The programs report a missing pad or sound
// device, and a touch is audible.
#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "client/commands/touch_command.hpp"
#include "common/cli/run_program.hpp"
#include "tests/integration/programs_fixture.hpp"
#include "tests/support/virtual_pad.hpp"

namespace hapticast::testing {
namespace {

using client::TickReport;

/// Somebody with a pad in the hands, who does a step as soon as what it waits for has come.
class Player final : public client::View {
 public:
  struct Step {
    const char* awaited;
    std::function<bool(const TickReport& report)> comes;
    std::function<void(const TickReport& report)> then;
  };
  explicit Player(std::vector<Step> steps) : steps_(std::move(steps)) {}

  void onPicture(VideoFrame /*picture*/, const Workspace& /*workspace*/) override {}
  void onReport(const TickReport& report) override { last_ = report; }
  bool update(client::UiState& /*desk*/) override {
    if (at_ == steps_.size()) return false;
    const Step& step = steps_[at_];
    if (step.comes(last_)) {
      step.then(last_);
      since_ = last_.time;
      ++at_;
    } else if (last_.time - since_ > kSoon) {
      ADD_FAILURE() << "never came: " << step.awaited;
      return false;
    }
    return true;
  }
  void finish() override { EXPECT_EQ(last_.force_N, Vec3(Vec3::Zero())) << "left with a force"; }
  [[nodiscard]] bool wantsVideo() const override { return false; }

 private:
  std::vector<Step> steps_;
  std::size_t at_ = 0;
  LocalTime since_{};
  TickReport last_;
};

class ProgramsGamepadTest : public ProgramsTest {
 protected:
  void SetUp() override {
    if (VirtualPad::others()) GTEST_SKIP() << "a real gamepad is plugged in";
  }
  /// The steps, done with a client of this server; its summary.
  nlohmann::json play(std::vector<Player::Step> steps, const std::string& address) {
    client::Settings settings;
    const auto colon = address.rfind(':');
    settings.server = {address.substr(0, colon),
                       static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1)))};
    settings.device = "gamepad";
    settings.summary_file = path("summary.json");
    settings.fault_folder = path("faults");
    settings.quiet = true;
    client::Views views;
    views.push_back(std::make_unique<Player>(std::move(steps)));
    const SteadyClock clock;
    EXPECT_EQ(client::runTouch(settings, clock, std::move(views)), kDone);
    EXPECT_EQ(pad.motors.low, 0) << "the motors turn on";
    EXPECT_EQ(pad.motors.high, 0);
    std::ifstream in(settings.summary_file);
    return nlohmann::json::parse(in);
  }
  void forward(double to) { pad.stick(SDL_CONTROLLER_AXIS_RIGHTY, -to); }
  /// As a person does who sees where the ball is. Whether the tip is over its middle.
  bool steerTo(const TickReport& report) {
    const Vec2 way_mm = report.object_centre_mm - report.hip_mm.head<2>();
    const bool near = way_mm.norm() < 4.0;
    const Vec2 to = near ? Vec2(Vec2::Zero()) : Vec2(0.7 * way_mm.normalized());
    pad.stick(SDL_CONTROLLER_AXIS_LEFTX, to.x());
    pad.stick(SDL_CONTROLLER_AXIS_LEFTY, -to.y());
    return near;
  }

  VirtualPad pad;
};

TEST_F(ProgramsGamepadTest, ContactRumblesAReleaseAndThePlugStopItAndItComesBack) {
  pad.plug();
  const auto server = startStillServer();
  const auto rumbles = [this](const TickReport& r) { return r.contact && pad.motors.low > 20000; };
  const auto is_quiet = [this] { return pad.motors.low == 0 && pad.motors.high == 0; };
  const auto rest = [this](const TickReport&) { forward(0.0); };
  const auto summary =
      play({{"a ball", [](const TickReport& r) { return r.object_present; },
             [&](const TickReport&) { EXPECT_TRUE(is_quiet()); }},
            {"the tip over it", [this](const TickReport& r) { return steerTo(r) && r.over_object; },
             [this](const TickReport&) { forward(0.8); }},
            {"a press that rumbles", rumbles, rest},
            {"a press, held",
             [this](const TickReport& r) {
               // A late machine ended the contact: the tip leaves, and presses again.
               forward(!r.contact ? 0.8 : pad.motors.low == 0 ? -0.8 : 0.0);
               return r.contact && pad.motors.low > 10000 && pad.motors.high < 15000;
             },
             [this](const TickReport&) { forward(-1.0); }},
            {"a release", [&](const TickReport& r) { return !r.contact && is_quiet(); },
             [this](const TickReport&) { forward(0.8); }},
            {"a second press", rumbles,
             [this](const TickReport&) {
               forward(0.0);
               pad.unplug();
             }},
            {"a lost device",
             [](const TickReport& r) {
               return r.halt == client::Halt::kDeviceLost && r.force_N == Vec3(Vec3::Zero());
             },
             [this](const TickReport&) {
               pad.motors = {};
               pad.plug();
             }},
            {"a device that is back", [](const TickReport& r) { return client::deviceIsBack(r); },
             [&](const TickReport&) {
               EXPECT_TRUE(is_quiet()) << "before it was asked for";
               pad.press(SDL_CONTROLLER_BUTTON_A);
             }},
            {"a force again, once the tip has left and come back",
             [this](const TickReport& r) {
               if (r.halt == client::Halt::kNone)
                 forward(r.contact && pad.motors.low == 0 ? -0.8 : 0.8);
               return r.contact && pad.motors.low > 20000;
             },
             [](const TickReport&) {}}},
           addressOf(*server));
  EXPECT_EQ(summary["step_excess_max_N"], 0.0);
  EXPECT_GT(summary["contact_ticks"], 100);
  interrupt(*server);
}

TEST_F(ProgramsGamepadTest, WithoutOneTheClientReportsSoAndEnds) {
  const auto client = startClient({"--device", "gamepad"});
  EXPECT_EQ(client->wait(kSoon), 1);
  EXPECT_EQ(
      countOccurrences("--device gamepad: none was found; is it plugged in?", client->output()), 1U)
      << client->output();
}

class ProgramsSoundTest : public ProgramsTest {
 protected:
  /// A client with --sound on this driver of SDL's.
  std::unique_ptr<Process> listen(const std::string& driver, const std::string& address) const {
    return start("/usr/bin/env",
                 {"SDL_AUDIODRIVER=" + driver, "SDL_DISKAUDIOFILE=" + path("heard.raw"),
                  HAPTICAST_CLIENT_PROGRAM, address, "--device", "virtual", "--hand", "press",
                  "--sound", "--log", path("log.csv")});
  }
  [[nodiscard]] bool touched() const {
    const auto rows = readLog(path("log.csv"));
    const auto pushed = std::count_if(rows.begin(), rows.end(),
                                      [](const LogRow& row) { return row.force_N.norm() > 0.5; });
    return pushed > 500;
  }
  /// The recorded sound, a number for each of SDL's buffers of 512: its loudest sample.
  [[nodiscard]] std::vector<float> heard() const {
    std::ifstream in(path("heard.raw"), std::ios::binary);
    std::vector<float> loudness;
    std::array<float, 512> buffer{};
    while (in.read(reinterpret_cast<char*>(buffer.data()), sizeof(buffer))) {
      float loudest = 0.0F;
      for (const float sample : buffer) loudest = std::max(loudest, std::abs(sample));
      loudness.push_back(loudest);
    }
    return loudness;
  }
};

TEST_F(ProgramsSoundTest, OnlyATouchIsAudible) {
  const auto server = startStillServer();
  const auto client = listen("disk", addressOf(*server));
  EXPECT_TRUE(waitUntil(kSoon, [this] { return touched(); })) << client->output();
  interrupt(*client);
  const auto loudness = heard();
  ASSERT_FALSE(loudness.empty());
  EXPECT_EQ(loudness.front(), 0.0F);
  EXPECT_GT(*std::max_element(loudness.begin(), loudness.end()), 0.1F);
  EXPECT_LE(*std::max_element(loudness.begin(), loudness.end()), 0.5F);
  EXPECT_LT(loudness.back(), 0.01F) << "it ended in the midst of it";
  interrupt(*server);
}

TEST_F(ProgramsSoundTest, WithoutASoundDeviceTheTouchGoesOn) {
  const auto server = startStillServer();
  const auto client = listen("nothing", addressOf(*server));
  EXPECT_TRUE(client->says("--sound: the client continues without sound: no sound device (", kSoon))
      << client->output();
  EXPECT_TRUE(waitUntil(kSoon, [this] { return touched(); })) << client->output();
  interrupt(*client);
  EXPECT_EQ(countOccurrences("--sound", client->output()), 1U) << client->output();
  const auto rows = readLog(path("log.csv"));
  EXPECT_EQ(rows.back().force_N, Vec3(Vec3::Zero()));
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
