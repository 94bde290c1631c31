// SPDX-License-Identifier: MIT
// The subcommand touch between a real server and a view that a test brings: a further view is one
// file.
#include "client/commands/touch_command.hpp"

#include <stdexcept>
#include <thread>

#include "common/cli/run_program.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

/// The input of a recording view.
struct Recorded {
  std::atomic<int> pictures{0};
  Workspace workspace;  // of the last picture
  std::uint64_t first_tick = 0;
  std::uint64_t last_tick = 0;
  LocalTime begin = localTime(-1.0);
  std::size_t reports = 0;
  bool in_order = true;
  int finished = 0;
};

/// The smallest view; `each_turn` is the test's, and decides whether to go on.
class RecordingView final : public client::View {
 public:
  RecordingView(Recorded& recorded, std::function<bool()> each_turn)
      : recorded_(recorded), each_turn_(std::move(each_turn)) {}
  void onPicture(VideoFrame /*picture*/, const Workspace& workspace) override {
    recorded_.workspace = workspace;
    ++recorded_.pictures;
  }
  void onReport(const client::TickReport& report) override {
    if (recorded_.reports++ == 0) {
      recorded_.first_tick = report.tick;
      recorded_.begin = report.time;
    }
    recorded_.in_order = recorded_.in_order && report.tick >= recorded_.last_tick;
    recorded_.last_tick = report.tick;
  }
  bool update(client::UiState& /*ui_state*/) override { return each_turn_(); }
  void finish() override { ++recorded_.finished; }

 private:
  Recorded& recorded_;
  std::function<bool()> each_turn_;
};

class TouchCommandTest : public ::testing::Test {
 protected:
  TouchCommandTest() : server(io, clock), network_([this] { io.run(); }) {}
  ~TouchCommandTest() override {
    asio::post(io, [this] { server.stop(); });
    work.reset();
  }
  /// Runs the subcommand with one view, which calls `each_turn`. Returns the exit code.
  int touchWith(std::function<bool()> each_turn) {
    client::Settings settings;
    settings.server = {"127.0.0.1", server.port()};
    settings.device = "virtual";
    settings.quiet = true;
    client::Views views;
    views.push_back(std::make_unique<RecordingView>(recorded, std::move(each_turn)));
    return client::runTouch(settings, clock, std::move(views));
  }
  void publishNext() {
    asio::post(io, [this, id = ++last_id_] {
      server.publish(id);
      server.broadcaster.publish(server::encodeVideo({0, id, server.media.now(), {0xFF, 0xD8, 1}}));
    });
  }

  SteadyClock clock;
  asio::io_context io;
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  TestServer server;
  Recorded recorded;

 private:
  std::uint64_t last_id_ = 0;
  std::jthread network_;  // last: it uses everything above
};

TEST_F(TouchCommandTest, AViewIsShownTicksAndPicturesAndEndsTheRun) {
  EXPECT_EQ(touchWith([this] {
              publishNext();
              return recorded.reports < 50 || recorded.pictures < 2;
            }),
            kDone);
  EXPECT_GE(recorded.reports, 50U);
  EXPECT_TRUE(recorded.in_order);
  EXPECT_EQ(recorded.begin, LocalTime{}) << "time begins with the first tick";
  EXPECT_EQ(recorded.last_tick - recorded.first_tick + 1, recorded.reports) << "every tick";
  EXPECT_GE(recorded.pictures, 2);
  EXPECT_EQ(recorded.workspace, TestServer::description().workspace);
  EXPECT_EQ(recorded.finished, 1);
}

TEST_F(TouchCommandTest, AnExceptionOfAViewEndsTheRunWithoutAHang) {
  EXPECT_EQ(touchWith([this]() -> bool {
              if (recorded.reports > 0) throw std::runtime_error("no display");
              return true;
            }),
            kFailed);
  EXPECT_GT(recorded.reports, 0U);
}

}  // namespace
}  // namespace hapticast::testing
