// SPDX-License-Identifier: MIT
#include "client/servers/server_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/protocol/messages.hpp"

namespace hapticast::client {
namespace {

FoundServer announced(const std::string& name, const std::string& address = "192.168.1.5",
                      const std::string& network = "eth0") {
  return {name, "desk.local", {address, 7447}, network, "ball", kProtocolVersion, ""};
}

TEST(FoundServers, OneThatIsOnManyNetworksIsShownOnceByIPv4First) {
  const auto servers = removeDuplicates({announced("b"), announced("a", "fe80::1%eth0"),
                                         announced("a", "10.0.0.5", "wlan0"), announced("a")});
  ASSERT_EQ(servers.size(), 2U);
  EXPECT_EQ(servers[0], announced("a"));
  EXPECT_EQ(servers[1], announced("b"));
}

TEST(FoundServers, ANameThatTwoHostsAnnounceIsNotChosen) {
  std::string why;
  EXPECT_EQ(only({announced("a"), announced("b")}, "b", why), announced("b"));
  EXPECT_EQ(only({announced("a")}, "c", why), std::nullopt);
  EXPECT_EQ(why, "no server announces this name");
  EXPECT_EQ(only({announced("a"), announced("a", "10.0.0.9")}, "a", why), std::nullopt);
  EXPECT_EQ(why, "more than one host announces this name: 192.168.1.5:7447, 10.0.0.9:7447");
}

TEST(FoundServers, LimitsAndCleansTextsOfTheNetwork) {
  FoundServer evil = announced("\x1b[31mred\n1  safe");
  evil.host = std::string(500, 'h');
  evil.plays = std::string(500, 'p') + "\x07";
  evil.version = kProtocolVersion + 1;
  const std::string words = toText({evil});
  EXPECT_EQ(words.find_first_of("\x1b\n\x07"), std::string::npos) << words;
  EXPECT_LT(words.size(), 400U);
  EXPECT_NE(words.find("protocol version "), std::string::npos) << words;

  std::vector<FoundServer> crowd;
  crowd.reserve(100);
  for (int i = 0; i < 100; ++i) crowd.push_back(announced("s" + std::to_string(100 + i)));
  const std::string all = toText(crowd);
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), static_cast<long>(kMaxListedServers)) << all;
  EXPECT_NE(all.find("and more, which are not shown"), std::string::npos) << all;
}

}  // namespace
}  // namespace hapticast::client
