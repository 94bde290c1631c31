// SPDX-License-Identifier: MIT
// The viewer of a page, as native code.
#include <gtest/gtest.h>

#include "client/web/viewer.hpp"

namespace hapticast::client {
namespace {

LocalTime at(int ms) { return localTime(1e-3 * ms); }

TEST(WebViewer, SaysThatItIsAPage) {
  WebViewer viewer({}, "secret");
  ASSERT_TRUE(viewer.open({.of_this_machine = true}, at(0)));
  const auto bytes = viewer.poll(at(0));
  ASSERT_TRUE(bytes);
  const auto hello = decode(*bytes);
  const auto& content = std::get<Hello>(hello.value());
  EXPECT_EQ(content.client_name, "web page");
  EXPECT_EQ(content.access_token, "secret");
  EXPECT_TRUE(content.wants_video && content.wants_frames_on_tcp && content.wants_acts);
  EXPECT_FALSE(viewer.poll(at(1))) << "before the welcome";
  WebViewer named({}, "", "Anna");
  ASSERT_TRUE(named.open({.of_this_machine = true}, at(0)));
  EXPECT_EQ(std::get<Hello>(decode(*named.poll(at(0))).value()).client_name, "Anna");
}

TEST(WebViewer, PingsQuicklyAtFirstAndThenReportsEachSecond) {
  WebViewer viewer;
  ASSERT_TRUE(viewer.open({}, at(0)));
  ASSERT_TRUE(viewer.poll(at(0)));
  ASSERT_TRUE(viewer.receive(encode(Welcome{kProtocolVersion, 1, 0, {}}), at(1)));
  int pings = 0, reports = 0;
  for (int ms = 1; ms <= 3000; ++ms)
    while (const auto bytes = viewer.poll(at(ms))) {
      const auto message = decode(*bytes);
      pings += std::holds_alternative<Ping>(message.value()) ? 1 : 0;
      reports += std::holds_alternative<ReceiverReport>(message.value()) ? 1 : 0;
    }
  EXPECT_GE(pings, 17);
  EXPECT_LE(pings, 19);
  EXPECT_GE(reports, 2);
}

TEST(WebViewer, HasTheReasonAndThePauseOfEachEnd) {
  WebViewer viewer(OriginPin("this link", {KeyBytes{1, 2, 3}}), "secret");
  EXPECT_FALSE(viewer.open({}, at(0))) << "the token would be readable";
  EXPECT_FALSE(viewer.close(at(0)));
  ASSERT_TRUE(viewer.open({.encrypted = true}, at(0)));
  EXPECT_TRUE(viewer.expire(at(6000)));
  EXPECT_EQ(viewer.close(at(6000)), std::chrono::milliseconds(200));
  ASSERT_TRUE(viewer.open({.encrypted = true}, at(7000)));
  EXPECT_FALSE(viewer.receive(encode(Welcome{kProtocolVersion, 1, 0, {}}), at(7001)));
  EXPECT_TRUE(viewer.end().untrusted);
  EXPECT_FALSE(viewer.close(at(7001))) << "a retry is useless";
}

TEST(WebViewer, ATickAtAGivenPositionReadsNoOther) {
  WebViewer viewer;
  const TickReport& report = viewer.tickAt(at(5), {1.0, 2.0, 3.0});
  EXPECT_EQ(report.inputs.reading.position_mm, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(report.force_N, Vec3::Zero());
  EXPECT_EQ(viewer.popHistory().size(), 4U);
  EXPECT_TRUE(viewer.popHistory().empty());
}

}  // namespace
}  // namespace hapticast::client
