// SPDX-License-Identifier: MIT
// Operators see each other's last act, its operator and its time.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

class OperatorActsTest : public StreamTest {
 protected:
  OperatorActsTest() {
    server.broadcaster.setAccess(
        server::AccessList::parse(
            "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb operator never\n"
            "3e23e8160039594a33894f6564e1b1348bbd7a0088d42c4acb73eeaed59c009d viewer never\n")
            .value());
    server.broadcaster.onControl(
        [](const Control&, const std::function<void()>& confirm) { confirm(); });
    turn();
  }
  /// A welcomed peer. The token "a" is an operator's, "b" a viewer's.
  std::unique_ptr<RawPeer> join(const std::string& name, const std::string& token,
                                bool wants_acts = true) {
    auto peer = std::make_unique<RawPeer>(io, server.port());
    peer->send(Hello{kProtocolVersion, name, false, true, token, false, wants_acts});
    EXPECT_TRUE(receives<Welcome>(*peer));
    return peer;
  }
  /// The acts of others that have come.
  static std::vector<Control> listActs(RawPeer& peer) {
    peer.poll();
    std::vector<Control> acts = peer.all<Control>();
    std::erase_if(acts, [](const Control& each) { return !each.at; });
    return acts;
  }
  bool receivesActs(RawPeer& peer, std::size_t count) {
    return runUntil([&] { return listActs(peer).size() >= count; });
  }

  TestServer server{io, clock};
};

TEST_F(OperatorActsTest, EachSeesTheLastActOfTheOther) {
  const auto anna = join("Anna", "a"), ben = join("Ben\n", "a"), old = join("old", "a", false),
             guest = join("guest", "b");
  const MediaTime before = server.media.now();
  anna->send(Control{true, {}, {}, {}, {}, "somebody", mediaTime(9e6)});
  ASSERT_TRUE(receives<Control>(*anna));
  ben->send(Control{false, {}, {}});
  ASSERT_TRUE(receivesActs(*anna, 1) && receivesActs(*ben, 1));
  const Control of_ben = listActs(*anna)[0], of_anna = listActs(*ben)[0];
  EXPECT_EQ(of_ben, (Control{false, {}, {}, {}, {}, "Ben?", of_ben.at}));
  EXPECT_EQ(of_anna, (Control{true, {}, {}, {}, {}, "Anna", of_anna.at}));
  EXPECT_TRUE(*of_anna.at >= before && *of_anna.at <= *of_ben.at);
  EXPECT_LE(*of_ben.at, server.media.now());
  EXPECT_EQ(anna->all<Control>()[0].at, std::nullopt) << "the answer to its own request";
  const auto late = join("late", "a");
  ASSERT_TRUE(receivesActs(*late, 1));
  EXPECT_EQ(listActs(*late)[0].operator_name, "Ben?");
  old->poll();
  guest->poll();
  EXPECT_TRUE(old->all<Control>().empty() && guest->all<Control>().empty());
}

TEST_F(OperatorActsTest, AStormOfRequestsBecomesOneActASecond) {
  const auto anna = join("Anna", "a"), ben = join("Ben", "a");
  const LocalTime begin = clock.now();
  for (int i = 0; i < 150; ++i) anna->send(Control{i % 2 == 0, {}, {}});
  ASSERT_TRUE(receives<Control>(*anna, 150));
  ASSERT_TRUE(receivesActs(*ben, 1));
  anna->send(Control{{}, 2.5, {}});
  ASSERT_TRUE(runUntil([&] {
    const auto acts = listActs(*ben);
    return acts.back().seek_s == 2.5;
  }));
  EXPECT_LE(static_cast<double>(listActs(*ben).size()), 2.0 + toSeconds(clock.now() - begin));
  EXPECT_TRUE(listActs(*anna).empty()) << "its own acts";
}

}  // namespace
}  // namespace hapticast::testing
