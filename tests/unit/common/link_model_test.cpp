// SPDX-License-Identifier: MIT
// The link of the tests itself: what it is asked to do to packets it does, at any seed.
#include "tests/support/link_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapticast::testing {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kPackets = 40000;
constexpr std::array<std::uint64_t, 4> kSeeds{1, 2, 77, 123456};

struct Passed {
  std::vector<bool> came;
  std::vector<double> delays_ms;  // of the first copies, in the order they were sent
  std::vector<LocalTime> arrivals;
  LinkCounts counts;
};

/// Datagrams of 1,000 bytes through a link, one every `every`.
Passed pass(const LinkProfile& profile, Duration every = milliseconds(1), int packets = kPackets) {
  LinkWay way{profile, {}, {}};
  LinkModel model(way);
  Passed passed;
  for (int i = 0; i < packets; ++i) {
    const LocalTime now = localTime(10.0) + i * every;
    const auto arrivals = model.datagram(now, 1000);
    passed.came.push_back(arrivals.count > 0);
    if (arrivals.count == 0) continue;
    passed.delays_ms.push_back(1e3 * toSeconds(arrivals.at[0] - now));
    passed.arrivals.push_back(arrivals.at[0]);
  }
  passed.counts = way.counts;
  return passed;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double each : values) sum += each;
  return sum / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  const double middle = mean(values);
  double sum = 0.0;
  for (const double each : values) sum += (each - middle) * (each - middle);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double lostShare(const Passed& passed) {
  return static_cast<double>(std::count(passed.came.begin(), passed.came.end(), false)) /
         static_cast<double>(passed.came.size());
}

double meanBurst(const Passed& passed) {
  int bursts = 0, lost = 0;
  for (std::size_t i = 0; i < passed.came.size(); ++i) {
    if (passed.came[i]) continue;
    ++lost;
    if (i == 0 || passed.came[i - 1]) ++bursts;
  }
  return static_cast<double>(lost) / bursts;
}

TEST(LinkModelTest, AGoodLinkPassesAllAtOnce) {
  const Passed passed = pass({});
  EXPECT_EQ(passed.arrivals.size(), static_cast<std::size_t>(kPackets));
  EXPECT_EQ(passed.counts.delay, Duration(0));
  EXPECT_EQ(passed.counts.bytes, 1000U * kPackets);
}

TEST(LinkModelTest, LosesTheShareItIsAskedTo) {
  for (const std::uint64_t seed : kSeeds) {
    const Passed passed = pass({.loss = 0.05, .seed = seed});
    EXPECT_NEAR(lostShare(passed), 0.05, 0.005) << seed;  // 4.6 standard deviations
    EXPECT_NEAR(meanBurst(passed), 1.0 / 0.95, 0.04) << seed;
    EXPECT_EQ(passed.counts.lost, kPackets - passed.arrivals.size());
  }
  EXPECT_TRUE(pass({.loss = 1.0}).arrivals.empty());
  EXPECT_TRUE(pass({.loss = 1.0, .burst = 5.0}).arrivals.empty());
}

TEST(LinkModelTest, LosesInBurstsOfTheLengthItIsAskedTo) {
  for (const std::uint64_t seed : kSeeds) {
    const Passed passed = pass({.loss = 0.05, .burst = 5.0, .seed = seed});
    EXPECT_NEAR(lostShare(passed), 0.05, 0.015) << seed;
    EXPECT_NEAR(meanBurst(passed), 5.0, 1.0) << seed;
  }
}

TEST(LinkModelTest, JitterIsSpreadAsAsked) {
  const auto far = seconds(10);  // apart: no packet waits for another to keep the order
  for (const std::uint64_t seed : kSeeds) {
    LinkProfile profile{.delay = milliseconds(50), .jitter = milliseconds(10), .seed = seed};
    const auto uniform = pass(profile, far).delays_ms;
    EXPECT_NEAR(mean(uniform), 55.0, 0.1);
    EXPECT_GE(*std::min_element(uniform.begin(), uniform.end()), 50.0);
    EXPECT_LE(*std::max_element(uniform.begin(), uniform.end()), 60.0);
    profile.distribution = Jitter::kNormal;
    const auto normal = pass(profile, far).delays_ms;
    EXPECT_NEAR(mean(normal), 50.0, 0.25);
    EXPECT_NEAR(deviation(normal), 10.0, 0.2);
    profile.distribution = Jitter::kExponential;
    auto exponential = pass(profile, far).delays_ms;
    EXPECT_NEAR(mean(exponential), 60.0, 0.25);
    std::nth_element(exponential.begin(), exponential.begin() + kPackets * 99 / 100,
                     exponential.end());
    EXPECT_NEAR(exponential[kPackets * 99 / 100], 50.0 + 10.0 * std::log(100.0), 2.5);
  }
  const auto near =
      pass({.jitter = milliseconds(10), .distribution = Jitter::kNormal}, far).delays_ms;
  EXPECT_EQ(*std::min_element(near.begin(), near.end()), 0.0) << "never before it was sent";
}

TEST(LinkModelTest, KeepsTheOrderUnlessItIsAskedNotTo) {
  const LinkProfile jittery{.delay = milliseconds(5), .jitter = milliseconds(20)};
  const auto ordered = pass(jittery).arrivals;
  EXPECT_TRUE(std::is_sorted(ordered.begin(), ordered.end()));
  LinkProfile profile;
  profile.reorder = 0.1;
  const Passed passed = pass(profile);
  EXPECT_NEAR(static_cast<double>(passed.counts.reordered), 0.1 * kPackets, 0.008 * kPackets);
  int overtaken = 0;
  for (std::size_t i = 0; i + 1 < passed.arrivals.size(); ++i) {
    overtaken += passed.arrivals[i + 1] < passed.arrivals[i];
  }
  // Of those held back 1 ms of up to 40 is too little to be overtaken, and the next may wait, too.
  EXPECT_GT(overtaken, 0.08 * kPackets);
  EXPECT_LE(*std::max_element(passed.delays_ms.begin(), passed.delays_ms.end()),
            1e3 * toSeconds(LinkModel::kHeldBack));
}

TEST(LinkModelTest, SendsCopies) {
  LinkWay way{{.delay = milliseconds(1), .jitter = milliseconds(5), .duplicate = 0.2}, {}, {}};
  LinkModel model(way);
  int copies = 0;
  for (int i = 0; i < kPackets; ++i) {
    const auto arrivals = model.datagram(localTime(0.1 * i), 100);
    ASSERT_GE(arrivals.count, 1U);
    if (arrivals.count < 2) continue;
    ++copies;
    ASSERT_LE(arrivals.at[0], arrivals.at[1]);
  }
  EXPECT_NEAR(copies, 0.2 * kPackets, 0.01 * kPackets);
  EXPECT_EQ(way.counts.duplicated, static_cast<std::uint64_t>(copies));
}

TEST(LinkModelTest, ANarrowPathSwallowsLargeDatagrams) {
  LinkWay way{{.largest_bytes = 1200}, {}, {}};
  LinkModel model(way);
  EXPECT_EQ(model.datagram(localTime(1.0), 1200).count, 1U);
  EXPECT_EQ(model.datagram(localTime(1.0), 1201).count, 0U);
  EXPECT_EQ(way.counts.too_large, 1U);
  way.profile.largest_bytes = 0;  // from now on
  EXPECT_EQ(model.datagram(localTime(1.0), 1).count, 0U);
  EXPECT_EQ(model.stream(localTime(1.0), 5000), localTime(1.0)) << "TCP finds its own size";
}

TEST(LinkModelTest, TheRateIsSharedAndTheQueueBounded) {
  LinkWay way{{.rate_bits_s = 8e6, .queue_bytes = std::size_t{10} * 1028}, {}, {}};
  LinkModel one(way, 0), other(way, 1);
  const LocalTime now = localTime(1.0);
  std::vector<LocalTime> arrivals;
  for (int i = 0; i < 20; ++i) {
    const auto each = (i % 2 == 0 ? one : other).datagram(now, 1000);
    if (each.count > 0) arrivals.push_back(each.at[0]);
  }
  ASSERT_EQ(arrivals.size(), 10U);
  EXPECT_EQ(way.counts.overflowed, 10U);
  for (std::size_t i = 0; i < 10; ++i) {  // a byte takes a microsecond
    EXPECT_EQ(arrivals[i], now + 1028 * microseconds(i + 1));
  }
  EXPECT_FALSE(one.room(now, 1));
  EXPECT_TRUE(one.room(now + microseconds(1028), 1028));
  // A second of 1,000 packets/s, a little more than fits.
  EXPECT_NEAR(static_cast<double>(pass(way.profile, microseconds(1000), 1000).arrivals.size()),
              1000.0 / 1.028, 11.0);
}

TEST(LinkModelTest, AStreamLosesNothingButTime) {
  LinkWay way{{.delay = milliseconds(30), .jitter = milliseconds(5), .loss = 0.01}, {}, {}};
  LinkModel model(way);
  LocalTime last;
  int stalls = 0, sent = 0;
  for (int i = 0; i < kPackets; ++i) {
    const LocalTime now = localTime(1.0 + 0.5 * i);
    const LocalTime at = model.stream(now, 2 * LinkModel::kSegmentBytes);
    ASSERT_GE(at, last);
    last = at;
    ++sent;
    stalls += at - now > milliseconds(100);
  }
  EXPECT_NEAR(static_cast<double>(stalls) / sent, 1.0 - 0.99 * 0.99, 0.004);
  EXPECT_EQ(way.counts.packets, 2U * kPackets);
  // What comes behind a lost packet waits for it.
  way.profile.loss = 1.0;
  const LocalTime now = last + seconds(1);
  const LocalTime at = model.stream(now, 1);
  EXPECT_GE(at, now + milliseconds(230));
  way.profile.loss = 0.0;
  EXPECT_GE(model.stream(now + milliseconds(1), 1), at);
  way.profile.loss = 1.0;
  way.profile.delay = milliseconds(150);
  EXPECT_GE(model.stream(now + seconds(1), 1), now + seconds(1) + milliseconds(450))
      << "a round trip, where that is longer";
}

TEST(LinkModelTest, IsTheSameAgainAndItsFaultsDoNotChangeEachOther) {
  const LinkProfile profile{.delay = milliseconds(5),
                            .jitter = milliseconds(10),
                            .loss = 0.1,
                            .burst = 3.0,
                            .duplicate = 0.1,
                            .reorder = 0.1,
                            .seed = 9};
  const Passed once = pass(profile);
  EXPECT_EQ(once.arrivals, pass(profile).arrivals);
  LinkProfile calm = profile;
  calm.jitter = Duration(0);
  calm.reorder = 0.0;
  EXPECT_EQ(pass(calm).came, once.came);
  LinkProfile other = profile;
  other.seed = 10;
  EXPECT_NE(pass(other).came, once.came);
  LinkWay way{profile, {}, {}};
  LinkModel flow(way, 1);
  std::vector<bool> came;
  came.reserve(kPackets);
  for (int i = 0; i < kPackets; ++i) came.push_back(flow.datagram(localTime(10.0), 1000).count > 0);
  EXPECT_NE(came, once.came);
}

}  // namespace
}  // namespace hapticast::testing
