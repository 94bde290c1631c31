// SPDX-License-Identifier: MIT
#include "server/stream/udp_fanout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

namespace hapticast::server {
namespace {

using Udp = asio::ip::udp;

Udp::endpoint loopback(std::uint16_t port = 0) { return {asio::ip::address_v4::loopback(), port}; }

SignedDatagrams bodies(std::size_t count, std::uint8_t value) {
  return std::make_shared<const std::vector<std::vector<std::uint8_t>>>(
      count, std::vector<std::uint8_t>(100, value));
}

/// Of these sizes, each full of its number.
SignedDatagrams sized(const std::vector<std::size_t>& sizes) {
  std::vector<std::vector<std::uint8_t>> made;
  made.reserve(sizes.size());
  for (const std::size_t size : sizes) made.emplace_back(size, made.size());
  return std::make_shared<const std::vector<std::vector<std::uint8_t>>>(std::move(made));
}

class UdpFanoutTest : public ::testing::Test {
 protected:
  UdpFanoutTest() { socket.non_blocking(true); }

  DatagramTarget target(std::uint64_t token, std::uint32_t copies = 1) {
    return {token, reader.local_endpoint(), {}, copies, std::make_shared<DatagramCounts>()};
  }
  /// The token and the first byte of the body of each datagram that has come.
  std::vector<std::pair<int, int>> came() {
    std::vector<std::pair<int, int>> found;
    for (const auto& each : datagrams()) {
      EXPECT_EQ(each.size(), 108U);
      found.emplace_back(each[0], each[8]);
    }
    return found;
  }
  std::vector<std::vector<std::uint8_t>> datagrams() {
    std::vector<std::vector<std::uint8_t>> found;
    reader.non_blocking(true);
    std::array<std::uint8_t, 2000> bytes{};
    boost::system::error_code ec;
    for (;;) {
      const std::size_t size = reader.receive(asio::buffer(bytes), 0, ec);
      if (ec) return found;
      found.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    }
  }

  asio::io_context io;
  Udp::socket socket{io, loopback()};
  Udp::socket reader{io, loopback()};
  UdpFanout out{socket};
};

TEST_F(UdpFanoutTest, AFrameGoesToAllAndCopiesComeLast) {
  const auto once = target(1);
  const auto twice = target(2, 2);
  out.send({bodies(2, 10), bodies(1, 20)}, {once, twice});
  EXPECT_EQ(came(),
            (std::vector<std::pair<int, int>>{{1, 10}, {1, 10}, {2, 10}, {2, 10}, {2, 20}}));
  EXPECT_EQ(once.counts->sent, 2U);
  EXPECT_EQ(once.counts->bytes, 2U * 108U);
  EXPECT_EQ(twice.counts->sent, 3U);
  EXPECT_EQ(twice.counts->bytes, 3U * 108U);
}

TEST_F(UdpFanoutTest, BodiesOfAllSizesArriveAsTheyAre) {
  // One message each: the two longest with a shorter one, two of one size with another, the last.
  const std::vector<std::size_t> sizes{60, 1224, 700, 1224, 60, 700, 700, 1};
  const auto viewer = target(7);
  out.send({sized(sizes)}, {viewer, target(8)});
  EXPECT_EQ(viewer.counts->sent, sizes.size());
  std::array<std::vector<bool>, 2> had;
  for (auto& each : had) each.assign(sizes.size(), false);
  for (const auto& each : datagrams()) {
    ASSERT_GT(each.size(), 8U);
    const std::size_t who = each[0] - 7U, body = each[8];
    ASSERT_TRUE(who < 2 && body < sizes.size());
    EXPECT_FALSE(had[who][body]) << "twice";
    had[who][body] = true;
    EXPECT_EQ(each.size(), 8 + sizes[body]);
    EXPECT_TRUE(std::all_of(each.begin() + 8, each.end(), [&](auto byte) { return byte == body; }));
  }
  const std::vector<bool> all(sizes.size(), true);
  EXPECT_EQ(had[0], all);
  EXPECT_EQ(had[1], all);
}

TEST_F(UdpFanoutTest, SendsDatagramsOneByOneWhereTheSystemDoesNotSegment) {
  // More than the loopback's own least unit, so that the system refuses to cut there.
  const auto viewer = target(1);
  const std::size_t whole = 65'507 - 8;
  out.send({sized({whole, whole})}, {viewer});
  EXPECT_EQ(viewer.counts->sent + viewer.counts->failed, 2U);
  EXPECT_EQ(viewer.counts->sent, 2U);
  EXPECT_EQ(viewer.counts->bytes, 2U * 65'507U);
}

TEST_F(UdpFanoutTest, ANewerFrameReplacesTheRestOfAnOlderOne) {
  const auto viewer = target(1);
  out.send({bodies(UdpFanout::kAtOnce + 500, 1)}, {viewer});
  EXPECT_EQ(viewer.counts->sent, UdpFanout::kAtOnce) << "then it lets others have their turn";
  out.send({bodies(3, 2)}, {viewer});
  EXPECT_EQ(viewer.counts->dropped, 500U);
  io.run();
  EXPECT_EQ(viewer.counts->sent, UdpFanout::kAtOnce + 3);
  EXPECT_EQ(viewer.counts->dropped, 500U);
}

TEST_F(UdpFanoutTest, ALongRoundGoesOnByItself) {
  const auto viewer = target(1);
  out.send({bodies(3 * UdpFanout::kAtOnce, 1)}, {viewer});
  io.run();
  EXPECT_EQ(viewer.counts->sent, 3 * UdpFanout::kAtOnce);
  EXPECT_EQ(viewer.counts->dropped, 0U);
}

TEST_F(UdpFanoutTest, ARefusalOfTheSystemDoesNotAffectOtherViewers) {
  auto impossible = target(1);
  impossible.from = asio::ip::make_address("203.0.113.77");  // not this machine's
  const auto other = target(2);
  out.send({bodies(20, 5)}, {impossible, other});
  io.run();
  EXPECT_EQ(impossible.counts->failed, 20U);
  EXPECT_EQ(impossible.counts->sent, 0U);
  EXPECT_EQ(other.counts->sent, 20U);
  EXPECT_EQ(came().size(), 20U);
}

TEST_F(UdpFanoutTest, AcceptsAnEmptyFrameAndNoTargets) {
  const auto viewer = target(1);
  out.send({}, {viewer});
  out.send({bodies(1, 1)}, {});
  out.dropRest();
  io.run();
  EXPECT_EQ(viewer.counts->sent + viewer.counts->dropped + viewer.counts->failed, 0U);
  EXPECT_TRUE(came().empty());
}

}  // namespace
}  // namespace hapticast::server
