// SPDX-License-Identifier: MIT
#include "server/http/host_names.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/text.hpp"

namespace hapticast::server {
namespace {

TEST(HostNames, OfAMachineAreItsNameAndThatOnTheLan) {
  EXPECT_EQ(listHostNames("desk", {}),
            (std::vector<std::string>{"localhost", "desk", "desk", "desk.local"}));
  EXPECT_EQ(listHostNames("desk.lab.example", {"figures.example"}),
            (std::vector<std::string>{"localhost", "desk.lab.example", "desk", "desk.local",
                                      "figures.example"}));
  EXPECT_EQ(listHostNames("", {}), (std::vector<std::string>{"localhost"}));
  EXPECT_EQ(listHostNames(findMachineName(), {}).front(), "localhost");
}

TEST(HostNames, AddressesAndOwnNamesAreOwnHosts) {
  const std::vector<std::string> names = listHostNames("desk", {"Figures.Example"});
  for (const char* own :
       {"localhost", "LocalHost:9464", "desk", "desk:80", "desk.local:9464", "DESK.LOCAL",
        "figures.example", "figures.example:", "127.0.0.1", "127.0.0.1:9464", "192.168.1.5:9464",
        "[::1]", "[::1]:9464", "[FE80::1]:80", "[::ffff:127.0.0.1]"})
    EXPECT_TRUE(isOwnHost(own, names)) << own;
}

TEST(HostNames, EveryOtherTextIsNone) {
  const std::vector<std::string> names = listHostNames("desk", {"figures.example"});
  for (const std::string other : {"",
                                  ":",
                                  ":9464",
                                  "evil.example",
                                  "desk.evil.example",
                                  "evil.desk",
                                  "desk.local.evil",
                                  "des",
                                  "desks",
                                  "desk evil",
                                  " desk",
                                  "desk:80:80",
                                  "desk:80a",
                                  "desk:-1",
                                  "evil@desk",
                                  "desk@evil",
                                  "127.0.0.1.evil.example",
                                  "127.0.0.1evil",
                                  "127.1",
                                  "2130706433",
                                  "0x7f.0.0.1",
                                  "::1",
                                  "[::1",
                                  "[::1]evil",
                                  "[::1]:80:80",
                                  "[]",
                                  "[desk]",
                                  "[127.0.0.1]"})
    EXPECT_FALSE(isOwnHost(other, names)) << other;
  EXPECT_FALSE(isOwnHost(std::string_view("127.0.0.1\0.evil", 15), names));
}

/// A name is accepted if and only if it is in the list, whatever the case and the port.
TEST(HostNames, RandomNamesAreAcceptedOnlyFromTheList) {
  std::mt19937 random(4);
  const auto randomName = [&random] {
    std::string name;
    for (std::uint32_t i = 0; i <= random() % 4; ++i) name += "aB.-"[random() % 4];
    return name;
  };
  int accepted = 0;
  for (int round = 0; round < 20'000; ++round) {
    const std::vector<std::string> names{randomName(), randomName()};
    const std::string asked = randomName();
    const std::string port = random() % 2 == 0 ? "" : ":9464";
    const std::string small = toLower(asked);
    const bool listed = small == toLower(names[0]) || small == toLower(names[1]);
    ASSERT_EQ(isOwnHost(asked + port, names), listed) << asked;
    accepted += listed ? 1 : 0;
  }
  EXPECT_GT(accepted, 500);
}

}  // namespace
}  // namespace hapticast::server
