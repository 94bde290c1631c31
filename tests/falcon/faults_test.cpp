// SPDX-License-Identifier: MIT
// Faults while a force acts, and the last command to the motors.
#include "tests/falcon/falcon_fixture.hpp"

namespace hapticast::testing {
namespace {

class FalconFaultsTest : public FalconTest {
 protected:
  void TearDown() override { end(); }

  /// A grip that is pushed.
  void push() {
    bootAndPlugIn();
    device_ = openFalcon();
    turning_ = std::make_unique<Turning>(*device_, clock_);
    turning_->push(2.0);
    ASSERT_TRUE(waitUntil(kPatience, [&] { return acts(); }));
  }
  void end() {
    if (turning_) turning_->stop();
    if (device_) resyncs_ = device_->traffic()->resyncs;
    device_.reset();
    turning_.reset();
  }
  bool acts() {
    const auto all = received();
    return !all.empty() && all.back().request.motors != kNoTorque;
  }
  bool waitForZero() {
    return waitUntil(kPatience, [&] { return !acts(); });
  }
  bool waitForForce() {
    return waitUntil(kPatience, [&] { return acts(); });
  }
  bool says(const std::string& text) {
    return waitUntil(kPatience, [&] {
      while (const auto line = device_->nextMessage()) logged_.append(*line).append("\n");
      return logged_.find(text) != std::string::npos;
    });
  }
  template <class Set>
  void fault(Set set) {
    port_->with([&](FalconModel& model, BusFaults& bus) { set(model, bus); });
  }
  /// It goes on under this fault, and the force is there; after it too.
  template <class Set, class Unset>
  void livesThrough(Set set, Unset unset) {
    push();
    fault(set);
    EXPECT_TRUE(turning_->runsAgain());
    fault(unset);
    EXPECT_TRUE(turning_->runsAgain());
    EXPECT_TRUE(waitForForce());
    EXPECT_EQ(turning_->lost(), 0);
    const bool happened = port_->with([](FalconModel&, BusFaults& bus) {
      return !bus.stall_in && !bus.stall_out && bus.protocol_errors == 0 && bus.babbles == 0;
    });
    EXPECT_TRUE(happened) << "and it is over";
    end();
    expectZeroAtLast();
  }

  std::unique_ptr<client::HapticDevice> device_;
  std::unique_ptr<Turning> turning_;
  std::uint64_t resyncs_ = 0;  // until the end
};

TEST_F(FalconFaultsTest, TheEndIsZeroSeveralTimesAndAnswered) {
  push();
  turning_->freeze();
  device_.reset();
  const auto all = received();
  ASSERT_GT(all.size(), 4U);
  for (std::size_t i = all.size() - 4; i < all.size(); ++i)
    EXPECT_EQ(all[i].request.motors, kNoTorque);
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, APlugThatIsPulledAndPutBack) {
  push();
  port_->unplug();
  EXPECT_TRUE(says("the connection is lost; no force"));
  EXPECT_TRUE(waitUntil(kPatience, [&] { return turning_->lost() > 10; }));
  EXPECT_TRUE(says("none was found on USB"));
  bootAndPlugIn();
  EXPECT_TRUE(says("the connection is restored"));
  EXPECT_TRUE(turning_->runsAgain());
  EXPECT_TRUE(waitForForce());
  end();
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, OneThatComesBackWithoutItsFirmwareGetsItAgain) {
  file_ = firmwareFile();
  push();
  port_->unplug();
  EXPECT_TRUE(says("the connection is lost"));
  port_->plugIn();
  EXPECT_TRUE(says("loading its firmware"));
  EXPECT_TRUE(turning_->runsAgain());
  end();
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, Stalls) {
  livesThrough([](FalconModel&, BusFaults& bus) { bus.stall_in = true; },
               [](FalconModel&, BusFaults& bus) { bus.stall_out = true; });
}

TEST_F(FalconFaultsTest, DamagedAndOverlongPackets) {
  livesThrough([](FalconModel&, BusFaults& bus) { bus.protocol_errors = 20; },
               [](FalconModel&, BusFaults& bus) { bus.babbles = 20; });
}

TEST_F(FalconFaultsTest, EmptyPackets) {
  livesThrough([](FalconModel& model, BusFaults&) { model.faults.empty_packets = true; },
               [](FalconModel& model, BusFaults&) { model.faults.empty_packets = false; });
}

TEST_F(FalconFaultsTest, RepliesInPieces) {
  livesThrough([](FalconModel& model, BusFaults&) { model.faults.split = true; },
               [](FalconModel& model, BusFaults&) { model.faults.split = false; });
}

TEST_F(FalconFaultsTest, RepliesThatAreLostCutAndBehindNoise) {
  livesThrough(
      [](FalconModel& model, BusFaults&) {
        model.faults.one_in_lost = 10;
        model.faults.one_in_cut = 10;
        model.faults.one_in_garbage = 10;
      },
      [](FalconModel& model, BusFaults&) { model.faults = {}; });
  EXPECT_GT(resyncs_, 0U);
}

TEST_F(FalconFaultsTest, FlippedBitsMoveNothing) {
  push();
  fault([](FalconModel& model, BusFaults&) { model.faults.one_in_flipped = 10; });
  EXPECT_TRUE(turning_->runsAgain());
  EXPECT_TRUE(turning_->runsAgain());
  fault([](FalconModel& model, BusFaults&) { model.faults = {}; });
  EXPECT_TRUE(turning_->runsAgain());
  end();
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, ASilentDeviceGetsZeroAndIsOpenedAgain) {
  push();
  fault([](FalconModel& model, BusFaults&) { model.faults.mute = true; });
  EXPECT_TRUE(waitForZero()) << "it hears, though it says nothing";
  EXPECT_TRUE(says("the connection is lost"));
  fault([](FalconModel& model, BusFaults&) { model.faults.mute = false; });
  EXPECT_TRUE(says("the connection is restored"));
  EXPECT_TRUE(waitForForce());
  end();
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, OneThatForgetsWhereItIs) {
  push();
  fault([](FalconModel& model, BusFaults&) { model.faults.homing_lost = true; });
  EXPECT_TRUE(waitForZero());
  EXPECT_TRUE(waitUntil(kPatience, [&] { return turning_->lost() > 0; }));
  EXPECT_TRUE(waitForForce()) << "the hand has homed it again";
  end();
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, AThreadOfEventsThatHangs) {
  push();
  fault([](FalconModel&, BusFaults& bus) { bus.hang = std::chrono::milliseconds(400); });
  EXPECT_TRUE(waitForZero()) << "the loop's own thread says it";
  EXPECT_TRUE(waitForForce()) << "it is over";
  end();
  expectZeroAtLast();
}

TEST_F(FalconFaultsTest, ALoopThatHangs) {
  push();
  turning_->freeze();
  EXPECT_TRUE(waitForZero()) << "the heartbeat is stale";
  end();
  expectZeroAtLast();
}

}  // namespace
}  // namespace hapticast::testing
