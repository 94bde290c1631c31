// SPDX-License-Identifier: MIT
// The viewer of a page, as native code.
#include <gtest/gtest.h>

#include "client/web/viewer.hpp"

namespace hapticast::client {
namespace {

LocalTime at(int ms) { return localTime(1e-3 * ms); }

TEST(WebViewer, SaysThatItIsAPage) {
  const auto hello = decode(WebViewer::makeHello("secret"));
  ASSERT_TRUE(hello.ok());
  const auto& content = std::get<Hello>(hello.value());
  EXPECT_EQ(content.access_token, "secret");
  EXPECT_TRUE(content.wants_video && content.wants_frames_on_tcp);
}

TEST(WebViewer, SendsNothingBeforeTheWelcome) {
  WebViewer viewer;
  EXPECT_FALSE(viewer.poll(at(0)));
  EXPECT_FALSE(viewer.receive(encode(Ping{at(0)}), at(1)).ok());
}

TEST(WebViewer, PingsQuicklyAtFirstAndThenReportsEachSecond) {
  WebViewer viewer;
  Welcome welcome{kProtocolVersion, 1, 0, {}};
  ASSERT_TRUE(viewer.receive(encode(welcome), at(1)).ok());
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

TEST(WebViewer, RefusesAnotherKeyThanThatOfTheLink) {
  WebViewer viewer(OriginPin("this link", {KeyBytes{1, 2, 3}}));
  Welcome welcome{kProtocolVersion, 1, 0, {}};
  const auto refused = viewer.receive(encode(welcome), at(1));
  ASSERT_FALSE(refused.ok());
  EXPECT_TRUE(viewer.untrusted());
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
