// SPDX-License-Identifier: MIT
#include "server/stream/udp_subscribers.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/manual_clock.hpp"

namespace hapticast::server {
namespace {

using asio::ip::make_address;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kStream = 7;

asio::ip::udp::endpoint udp(const char* host, std::uint16_t port) {
  return {make_address(host), port};
}

class UdpSubscribersTest : public ::testing::Test {
 protected:
  AddressValidation echo(std::uint64_t token, const asio::ip::udp::endpoint& from) {
    return book.onEcho(echoBytes({token, kStream}), from, now);
  }
  [[nodiscard]] std::size_t takers() {
    std::size_t count = 0;
    book.forEachSubscriber([&count](std::uint64_t, const UdpSubscribers::Viewer&) { ++count; });
    EXPECT_EQ(book.hasSubscribers(), count > 0);
    return count;
  }

  LocalTime now = localTime(100);
  UdpSubscribers book{kStream};
  std::uint64_t ann = book.add(make_address("192.0.2.1"), make_address("192.0.2.9"));
};

TEST_F(UdpSubscribersTest, SendsNoDatagramBeforeAValidEcho) {
  EXPECT_NE(ann, 0U);
  EXPECT_EQ(takers(), 0U);
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  EXPECT_EQ(takers(), 1U);
  EXPECT_EQ(book.find(ann)->at, udp("192.0.2.1", 5000));
}

TEST_F(UdpSubscribersTest, AcceptsEchoesOfTheHostOfTheConnectionOnly) {
  EXPECT_EQ(echo(ann, udp("192.0.2.2", 5000)), AddressValidation::kForeign);
  EXPECT_EQ(echo(ann + 1, udp("192.0.2.1", 5000)), AddressValidation::kUnknownToken);
  EXPECT_EQ(book.onEcho(echoBytes({ann, kStream + 1}), udp("192.0.2.1", 5000), now),
            AddressValidation::kOtherStream);
  EXPECT_EQ(book.onEcho(std::vector<std::uint8_t>(13), udp("192.0.2.1", 5000), now),
            AddressValidation::kMalformed);
  EXPECT_EQ(takers(), 0U);
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  EXPECT_EQ(echo(ann, udp("198.51.100.1", 5000)), AddressValidation::kForeign);
  EXPECT_EQ(book.find(ann)->at, udp("192.0.2.1", 5000)) << "an unknown sender moves nothing";
}

TEST_F(UdpSubscribersTest, BothVersionsOfAnAddressAreTheSameHost) {
  const std::uint64_t bob =
      book.add(make_address("::ffff:192.0.2.3"), make_address("::ffff:192.0.2.9"));
  EXPECT_EQ(echo(bob, udp("::ffff:192.0.2.3", 1)), AddressValidation::kValidated);
  EXPECT_EQ(echo(ann, udp("::ffff:192.0.2.1", 1)), AddressValidation::kValidated);
  const std::uint64_t eve = book.add(make_address("2001:db8::1"), make_address("2001:db8::9"));
  EXPECT_EQ(echo(eve, udp("2001:db8::2", 1)), AddressValidation::kForeign);
  EXPECT_EQ(echo(eve, udp("2001:db8::1", 1)), AddressValidation::kValidated);
}

TEST_F(UdpSubscribersTest, TheNewestPortWinsButNotAHundredAtOnce) {
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  for (std::uint16_t port = 6000; port < 6100; ++port)
    EXPECT_EQ(echo(ann, udp("192.0.2.1", port)), AddressValidation::kTooSoon);
  EXPECT_EQ(book.find(ann)->at, udp("192.0.2.1", 5000));
  now += UdpSubscribers::kLeastPause;
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 7000)), AddressValidation::kValidated);
  EXPECT_EQ(book.find(ann)->at, udp("192.0.2.1", 7000));
  EXPECT_EQ(takers(), 1U);
}

TEST_F(UdpSubscribersTest, RemovesASilentViewerAfterHalfAMinute) {
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  now += seconds(10);
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  now += seconds(30) - milliseconds(1);
  book.forget(now);
  EXPECT_EQ(takers(), 1U);
  now += milliseconds(1);
  book.forget(now);
  EXPECT_EQ(takers(), 0U);
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated) << "it may come back";
}

TEST_F(UdpSubscribersTest, DeliverySetsWhetherAndHowOften) {
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  book.setDelivery(ann, {true, false, 1});
  EXPECT_EQ(takers(), 0U);
  book.setDelivery(ann, {false, true, 3});
  EXPECT_EQ(takers(), 1U);
  EXPECT_EQ(book.find(ann)->copies, 3U);
  book.setDelivery(ann + 1, {false, true, 3});
  EXPECT_EQ(book.size(), 1U) << "nobody's token makes nobody";
}

TEST_F(UdpSubscribersTest, RemovesTheTokenOfAViewerThatLeaves) {
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  book.find(ann)->counts->sent = 12;
  EXPECT_EQ(book.remove(ann).sent, 12U);
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kUnknownToken);
  EXPECT_EQ(book.remove(ann).sent, 0U);
}

TEST_F(UdpSubscribersTest, AnotherStreamBeginsWithoutViewers) {
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kValidated);
  book.find(ann)->counts->sent = 12;
  EXPECT_EQ(book.restart(kStream + 1).sent, 12U);
  EXPECT_EQ(book.size(), 0U);
  EXPECT_EQ(echo(ann, udp("192.0.2.1", 5000)), AddressValidation::kOtherStream);
  const auto bytes = echoBytes({ann, kStream + 1});
  EXPECT_EQ(book.onEcho(bytes, udp("192.0.2.1", 5000), now), AddressValidation::kUnknownToken);
}

TEST_F(UdpSubscribersTest, TokensAreUnguessableAndTheirOwn) {
  std::set<std::uint64_t> tokens{0, ann};
  for (int i = 0; i < 1000; ++i)
    EXPECT_TRUE(
        tokens.insert(book.add(make_address("192.0.2.1"), make_address("192.0.2.9"))).second);
}

TEST_F(UdpSubscribersTest, TheGroupGetsTheCopiesThatNineOfTenViewersNeed) {
  EXPECT_EQ(book.groupCopies(), 1U);
  for (std::uint32_t i = 0; i < 10; ++i) {
    const std::uint64_t token = book.add(make_address("192.0.2.1"), make_address("192.0.2.9"));
    book.setDelivery(token, {false, false, i < 8 ? 1U : i == 8 ? 2U : 4U});
  }
  book.setDelivery(ann, {false, true, 4});  // not the group's
  EXPECT_EQ(book.groupCopies(), 2U) << "the tenth has to do with it";
}

}  // namespace
}  // namespace hapticast::server
