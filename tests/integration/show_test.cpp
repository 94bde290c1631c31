// SPDX-License-Identifier: MIT
// The examples of server/show/README.md: a producer, a sink and a subcommand of one's own, and what
// a show does with them.
#include "server/show/show.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/cli/subcommands.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/frame_ids.hpp"

namespace hapticast::server {
namespace {

/// A producer of a plate that comes nearer in each of five frames, 10 ms apart.
class Pulse final : public Producer {
 public:
  Pulse(const Clock& clock, FrameIds& ids) : media_clock_(clock), ids_(ids) {}

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override {
    StreamDescription description;
    description.name = "pulse";
    description.fps = 100.0;
    return description;
  }
  void start() override { due_ = media_clock_.now(); }
  bool step() override {
    if (next_id_ > 5) return false;
    if (!show_->waitUntil(due_)) return true;
    HapticFrame frame;
    frame.id = next_id_++;
    frame.media_time = due_;
    frame.objects.push_back({1, 0, 1, flatRelief({0, 0, 8, 8}), {}, nullptr, {}, {}});
    std::vector<StreamSink*> sinks = show_->sinks().all();
    sinks.push_back(&ids_);
    rotateKey(show_->sinks().signer(), sinks);
    const EncodedFrame encoded =
        encoder_.encode(frame, {}, &show_->sinks().signer(), areDatagramsWanted(sinks));
    for (StreamSink* sink : sinks) sink->publish(encoded);
    due_ += std::chrono::milliseconds(10);
    if (fails) throw std::runtime_error("the pulse has stopped");
    return true;
  }
  void release() noexcept override { is_released = true; }

  bool fails = false;  // after its first frame
  bool is_released = false;

 private:
  LocalMediaClock media_clock_;
  FrameIds& ids_;
  FrameEncoder encoder_;
  MediaTime due_{};
  std::uint64_t next_id_ = 1;
};

/// Adds a subcommand with one flag. Without a value of its own it writes to `count`.
void addCountCommand(CLI::App& program, std::uint64_t& count, bool& was_chosen) {
  CLI::App& app = addSubcommand(program, "count", "Count the frames");
  addNumber(app, "--from", count, std::uint64_t{1}, std::uint64_t{100}, "N", "The first number");
  app.final_callback([&was_chosen] { was_chosen = true; });
}

class ShowTest : public ::testing::Test {
 protected:
  ShowTest() { settings_.listen = {"127.0.0.1", 0}; }

  SteadyClock clock_;
  Settings settings_;
  FrameIds ids_;
  Pulse pulse_{clock_, ids_};
};

TEST_F(ShowTest, EverySinkGetsEachFrame) {
  Show show(settings_, clock_, nullptr, pulse_);
  EXPECT_TRUE(show.run());
  EXPECT_TRUE(show.streaming());
  EXPECT_EQ(ids_.ids, (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(show.sinks().service().broadcaster().counts().frames, 5U);
  EXPECT_TRUE(pulse_.is_released);
}

TEST_F(ShowTest, AStoppedShowDoesNotBegin) {
  Show show(settings_, clock_, nullptr, pulse_);
  show.stop();
  EXPECT_TRUE(show.run());
  EXPECT_FALSE(show.streaming());
  EXPECT_TRUE(ids_.ids.empty());
}

TEST_F(ShowTest, AFailureReleasesTheProducer) {
  pulse_.fails = true;
  Show show(settings_, clock_, nullptr, pulse_);
  EXPECT_THROW((void)show.run(), std::runtime_error);
  EXPECT_TRUE(show.streaming()) << "exit code 1, not 2";
  EXPECT_TRUE(pulse_.is_released);
}

TEST_F(ShowTest, ASubcommandHasItsFlags) {
  CLI::App program("counts");
  program.require_subcommand(1);
  std::uint64_t count = 1;
  bool was_chosen = false;
  addCountCommand(program, count, was_chosen);
  const std::vector<const char*> arguments{"counts", "count", "--from", "7"};
  EXPECT_EQ(parseArguments(program, 4, arguments.data(), {.otherwise = "count"}), std::nullopt);
  EXPECT_TRUE(was_chosen);
  EXPECT_EQ(count, 7U);
}

}  // namespace
}  // namespace hapticast::server
