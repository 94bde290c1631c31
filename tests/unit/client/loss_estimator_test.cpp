// SPDX-License-Identifier: MIT
#include "client/net/udp/loss_estimator.hpp"

#include <gtest/gtest.h>

#include <random>

namespace hapticast::client {
namespace {

/// 25 frames a second of so many parts, each copy of which is lost by chance.
struct Network {
  std::uint32_t play(double seconds, double loss, std::uint16_t parts = 3) {
    std::uint32_t copies = meter.copies(localTime(now_s));
    for (const double until_s = now_s + seconds; now_s < until_s; now_s += 0.04) {
      ++id;
      for (std::uint32_t copy = 0; copy < copies && copy < id; ++copy) {
        for (int part = 0; part < parts; ++part) {
          if (std::uniform_real_distribution(0.0, 1.0)(random) < loss) continue;
          meter.add({1, 1, id - copy, {}, static_cast<std::uint16_t>(part), parts});
        }
      }
      copies = meter.copies(localTime(now_s));
    }
    return copies;
  }

  LossEstimator meter;
  std::mt19937 random{3};
  std::uint64_t id = 1000;
  double now_s = 50.0;
};

TEST(LossEstimator, AsksForNothingWhereNothingIsLostOnceItIsSure) {
  Network network;
  EXPECT_EQ(network.play(2.0, 0.0), LossEstimator::kFirstCopies);
  EXPECT_EQ(network.play(3.0, 0.0), 2U) << "no measurement asked for the first redundancy";
  EXPECT_EQ(network.play(20.0, 0.0), 2U) << "patience";
  EXPECT_EQ(network.play(75.0, 0.0), 1U);
  EXPECT_LT(network.meter.loss(), 1e-6);
}

TEST(LossEstimator, MeasuresTheLossAtAnyNumberOfCopies) {
  for (const double loss : {0.01, 0.05, 0.1, 0.2}) {
    Network network;
    (void)network.play(60.0, loss);
    EXPECT_NEAR(network.meter.loss(), loss, 0.5 * loss + 0.01) << loss;
  }
}

TEST(LossEstimator, ALossThatBeginsCountsInFullAtOnce) {
  Network network{.meter = LossEstimator(1, true)};
  (void)network.play(5.0, 0.0);
  (void)network.play(2.5, 0.5);  // time for two updates
  EXPECT_GT(network.meter.loss(), 0.42);
}

TEST(LossEstimator, MoreCopiesForMoreLossAndFewerAfterAWhile) {
  Network network;
  EXPECT_EQ(network.play(10.0, 0.02), 2U) << "0.04 % are lost twice";
  EXPECT_GE(network.play(10.0, 0.1), 3U);
  EXPECT_EQ(network.play(10.0, 0.3), 4U);
  EXPECT_EQ(network.play(5.0, 0.0), 4U) << "patience";
  EXPECT_EQ(network.play(100.0, 0.0), 1U);
}

TEST(LossEstimator, CopiesThatAreLostTogetherAskForMore) {
  LossEstimator meter;
  std::uint32_t copies = meter.copies(localTime(50.0));
  for (std::uint64_t id = 1000; id < 1500; ++id) {
    if (id % 50 < 2) continue;  // of independent losses so rare two copies would be enough
    for (std::uint32_t copy = 0; copy < copies; ++copy) meter.add({1, 1, id - copy, {}, 0, 1});
    copies = meter.copies(localTime(0.04 * static_cast<double>(id)));
  }
  EXPECT_NEAR(meter.loss(), 0.04, 0.04);
  EXPECT_EQ(copies, 3U);
}

TEST(LossEstimator, FramesOfWhichNothingComesCount) {
  Network network;
  (void)network.play(30.0, 0.5, 1);
  EXPECT_NEAR(network.meter.loss(), 0.5, 0.15);
}

TEST(LossEstimator, AnotherNumberingIsNoLoss) {
  Network network;
  for (const std::uint64_t from : {1'000'000'000ULL, ~0ULL - 2000, 5000ULL, 20'000ULL, 0ULL}) {
    (void)network.play(75.0, 0.0);
    network.id = from;
    EXPECT_EQ(network.play(10.0, 0.0), 1U) << from;
  }
  (void)network.play(30.0, 0.1);
  EXPECT_NEAR(network.meter.loss(), 0.1, 0.06) << "and loss is seen";
}

TEST(LossEstimator, AnUnsignedDatagramStartsNoFrame) {
  Network network;
  (void)network.play(75.0, 0.0);
  for (std::uint64_t i = 0; i < 10'000; ++i)
    network.meter.onDuplicate({1, 1, network.id + i * i, {}, 0, 3});
  network.meter.onDuplicate({1, 1, ~0ULL, {}, 0, 3});
  EXPECT_EQ(network.play(10.0, 0.0), 1U);
  EXPECT_LT(network.meter.loss(), 1e-6);
}

TEST(LossEstimator, MeasuresFixedCopiesToo) {
  Network network{.meter = LossEstimator(3, true)};
  EXPECT_EQ(network.play(60.0, 0.1), 3U);
  EXPECT_NEAR(network.meter.loss(), 0.1, 0.06);
}

}  // namespace
}  // namespace hapticast::client
