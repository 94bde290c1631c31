// SPDX-License-Identifier: MIT
// The check of a device before its first force: in a terminal, in a window, and without either. The
// stand-in driver has a free grip.
#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <set>

#include "client/commands/touch_command.hpp"
#include "client/view/window/window.hpp"
#include "common/cli/run_program.hpp"
#include "tests/integration/driver_fixture.hpp"

namespace hapticast::testing {
namespace {

/// A terminal with a user: a pseudo-terminal.
class Terminal {
 public:
  Terminal() : user_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(::grantpt(user_), 0);
    EXPECT_EQ(::unlockpt(user_), 0);
    name_ = ::ptsname(user_);
  }
  ~Terminal() { ::close(user_); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  void type(const std::string& text) const {
    EXPECT_EQ(::write(user_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  int user_;
  std::string name_;
};

/// The real window. Its user presses Enter when the client asks.
class ConfirmingView final : public client::View {
 public:
  struct Seen {
    int ticks = 0;
    std::set<std::string> requests;
    cv::Mat pixels;  // of the first request
  };
  explicit ConfirmingView(Seen& seen) : seen_(seen) {}
  void onPicture(VideoFrame /*picture*/, const Workspace& /*workspace*/) override {}
  void onReport(const client::TickReport& report) override {
    ++seen_.ticks;
    window_.onReport(report);
  }
  bool update(client::UiState& ui_state) override {
    const bool asks = !ui_state.request.empty() && seen_.requests.insert(ui_state.request).second;
    if (asks && seen_.requests.size() == 1) {
      window_.draw(ui_state);
      seen_.pixels = window_.pixels();
      SDL_Event event{};
      event.type = SDL_KEYDOWN;
      event.key.keysym.sym = SDLK_RETURN;
      SDL_PushEvent(&event);
    }
    return window_.update(ui_state) && seen_.ticks < 100;
  }
  void finish() override { window_.finish(); }
  [[nodiscard]] bool points() const override { return window_.points(); }
  [[nodiscard]] bool wantsVideo() const override { return false; }

 private:
  client::ViewerWindow window_{960, 540};
  Seen& seen_;
};

class ProgramsFirstCheckTest : public ProgramsWithDriverTest {
 protected:
  void SetUp() override {
    stateFolder().forgetChecks();
    const std::string devices = path("data/hapticast/devices");
    std::filesystem::create_directories(devices);
    std::filesystem::copy_file(HAPTICAST_STANDINS "/standin.so", devices + "/standin.so");
    std::filesystem::permissions(devices + "/standin.so", std::filesystem::perms(0644));
    std::filesystem::permissions(devices, std::filesystem::perms(0755));
    ::setenv("XDG_DATA_HOME", path("data").c_str(), 1);
    ::setenv("STANDIN_HAND", "free", 1);
  }
  void TearDown() override {
    ::unsetenv("XDG_DATA_HOME");
    ::unsetenv("STANDIN_HAND");
  }
  std::unique_ptr<Process> startWith(const std::string& input, const std::string& fault = "",
                                     std::vector<std::string> command = {"127.0.0.1:1", "--view",
                                                                         "off"}) {
    command.insert(command.begin(), HAPTICAST_CLIENT_PROGRAM);
    command.insert(command.end(), {"--device", "standin", "--device-option",
                                   "trace=" + trace_.file(), "--device-option", "fault=" + fault});
    return std::make_unique<Process>(std::move(command), input);
  }
  /// Presses Enter until the check begins: what the user typed before the request counts as
  /// nothing, also what comes at the same moment.
  void confirm(Process& client) const {
    EXPECT_TRUE(waitUntil(kSoon, [&] {
      if (trace_->most_N > 0.0 || !client.running()) return true;
      terminal_.type("\n");
      return false;
    })) << client.output();
  }

  const Trace trace_{path("trace")};
  const Terminal terminal_;
};

TEST_F(ProgramsFirstCheckTest, ATerminalIsAskedOnceAndTheForceIsSmall) {
  const auto client = startWith(terminal_.name());
  ASSERT_TRUE(client->says("let go of the grip, then press Enter", kSoon)) << client->output();
  EXPECT_EQ(trace_->most_N, 0.0) << "before Enter";
  EXPECT_EQ(client->output().find("connecting to"), std::string::npos);
  confirm(*client);
  EXPECT_TRUE(client->says("check: the device follows in sign and axis", kSoon))
      << client->output();
  EXPECT_TRUE(client->says("connecting to", kSoon)) << client->output();
  interrupt(*client);
  EXPECT_GT(trace_->most_N, 0.25);
  EXPECT_LE(trace_->most_N, 0.3 + 1e-9);
  EXPECT_EQ(trace_->force_N, 0.0);
  const auto again = startWith("/dev/null");
  EXPECT_TRUE(again->says("connecting to", kSoon)) << again->output();
  interrupt(*again);
}

TEST_F(ProgramsFirstCheckTest, ASignalEndsTheRequestAndTheCheck) {
  for (const bool confirmed : {false, true}) {
    const auto client = startWith(terminal_.name());
    ASSERT_TRUE(client->says("press Enter", kSoon)) << client->output();
    if (confirmed) {
      confirm(*client);
      EXPECT_TRUE(waitUntil(kSoon, [&] { return trace_->force_N > 0.2; })) << client->output();
    }
    interrupt(*client);
    EXPECT_EQ(trace_->force_N, 0.0);
  }
}

TEST_F(ProgramsFirstCheckTest, WithoutATerminalTheClientNamesTheCommand) {
  const auto client = startWith("/dev/null");
  EXPECT_EQ(client->wait(kSoon), 1);
  EXPECT_NE(client->output().find("run hapticast-client check standin first"), std::string::npos)
      << client->output();
  EXPECT_EQ(trace_->most_N, 0.0);
  const auto command =
      startClient({"--check-device", "standin", "--device-option", "trace=" + trace_.file()});
  EXPECT_EQ(command->wait(kSoon), 0) << command->output();
  const auto checked = startWith("/dev/null");
  EXPECT_TRUE(checked->says("connecting to", kSoon)) << checked->output();
  interrupt(*checked);
}

TEST_F(ProgramsFirstCheckTest, AVirtualDevicePasses) {
  const auto client = startClient({"--check-device", "virtual"});
  EXPECT_EQ(client->wait(kSoon), 0) << client->output();
}

TEST_F(ProgramsFirstCheckTest, ATurnedAxisIsRefusedAndIsNotStored) {
  const auto client = startWith(terminal_.name(), "turned");
  ASSERT_TRUE(client->says("press Enter", kSoon)) << client->output();
  confirm(*client);
  EXPECT_EQ(client->wait(kSoon), 1) << client->output();
  EXPECT_NE(client->output().find("the client refuses the device standin S1: a push of 0.3 N along "
                                  "y (up) moved the grip by"),
            std::string::npos)
      << client->output();
  EXPECT_LE(trace_->most_N, 0.3 + 1e-9);
  EXPECT_EQ(trace_->force_N, 0.0);
  EXPECT_EQ(startWith("/dev/null")->wait(kSoon), 1) << "still not checked";
}

TEST_F(ProgramsFirstCheckTest, ADeviceLostInTheCheckFailsTouchAndStudyAlike) {
  const std::vector<std::vector<std::string>> commands = {{"127.0.0.1:1", "--view", "off"},
                                                          makeStudy(R"([{"name": "one"}])")};
  for (const auto& command : commands) {
    trace_->go = 0;
    trace_->most_N = 0.0;
    const auto client = startWith(terminal_.name(), "lost", command);
    ASSERT_TRUE(client->says("press Enter", kSoon)) << client->output();
    trace_->go = 1;
    confirm(*client);
    EXPECT_EQ(client->wait(kSoon), 1) << client->output();
    EXPECT_TRUE(client->says("check: the device stopped answering", kSoon)) << client->output();
    EXPECT_EQ(countOccurrences(" error ", client->output()), 1U) << client->output();
  }
}

TEST_F(ProgramsFirstCheckTest, EnterInTheWindowConfirms) {
  ::setenv("SDL_VIDEODRIVER", "dummy", 1);
  ::setenv("SDL_RENDER_DRIVER", "software", 1);
  client::Settings settings;
  settings.server = {"127.0.0.1", 1};
  settings.device = "standin";
  settings.device_options = {{"trace", trace_.file()}};
  settings.quiet = true;
  ConfirmingView::Seen seen;
  client::Views views;
  views.push_back(std::make_unique<ConfirmingView>(seen));
  const SteadyClock clock;
  EXPECT_EQ(client::runTouch(settings, clock, std::move(views)), kDone);
  EXPECT_GE(seen.ticks, 100) << "the loop runs after the check";
  EXPECT_EQ(seen.requests.size(), 2U) << "the request, and the state meanwhile";
  EXPECT_FALSE(seen.pixels.empty());
  EXPECT_LE(trace_->most_N, 0.3 + 1e-9);
}

}  // namespace
}  // namespace hapticast::testing
