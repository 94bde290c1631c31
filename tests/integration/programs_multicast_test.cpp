// SPDX-License-Identifier: MIT
// Both programs on two hosts (network namespaces) with a cable between them: groups of IPv4 and
// IPv6, on a named interface and on none, and how far datagrams may go.
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/support/two_hosts.hpp"

namespace hapticast::testing {
namespace {

struct GroupCase {
  const char* name;
  const char* group;
  bool v6;
  bool named;  ///< the interface, at both ends
  int hops;    ///< 0: not said
};

/// Takes the group's datagrams as they are on the cable.
class HopCounter {
 public:
  HopCounter() = default;
  HopCounter(asio::io_context& io, const asio::ip::address& group, std::uint16_t port,
             const char* link) {
    const bool v6 = group.is_v6();
    socket_ = std::make_unique<asio::ip::udp::socket>(io);
    socket_->open(v6 ? asio::ip::udp::v6() : asio::ip::udp::v4());
    socket_->set_option(asio::socket_base::reuse_address(true));
    const unsigned index = ::if_nametoindex(link);
    auto bound = group;
    if (v6) {
      auto scoped = group.to_v6();
      scoped.scope_id(index);
      bound = scoped;
      socket_->set_option(asio::ip::multicast::join_group(scoped, index));
    } else {
      socket_->set_option(asio::ip::multicast::join_group(
          group.to_v4(), asio::ip::make_address_v4(TwoHosts::kViewer4)));
    }
    socket_->bind({bound, port});
    const int yes = 1;
    if (::setsockopt(socket_->native_handle(), v6 ? IPPROTO_IPV6 : IPPROTO_IP,
                     v6 ? IPV6_RECVHOPLIMIT : IP_RECVTTL, &yes, sizeof yes) != 0)
      throw std::runtime_error("the system does not tell how far a datagram may go");
    socket_->non_blocking(true);
  }
  /// Of the datagrams that have come, each.
  std::vector<int> take() {
    std::vector<int> hops;
    for (;;) {
      std::array<char, 2000> bytes{};
      alignas(cmsghdr) std::array<char, 128> control{};
      iovec part{bytes.data(), bytes.size()};
      msghdr message{};
      message.msg_iov = &part;
      message.msg_iovlen = 1;
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      if (::recvmsg(socket_->native_handle(), &message, 0) < 0) return hops;
      for (cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr;
           each = CMSG_NXTHDR(&message, each)) {
        const bool v4 = each->cmsg_level == IPPROTO_IP && each->cmsg_type == IP_TTL;
        const bool v6 = each->cmsg_level == IPPROTO_IPV6 && each->cmsg_type == IPV6_HOPLIMIT;
        if (v4 || v6) std::memcpy(&hops.emplace_back(), CMSG_DATA(each), sizeof(int));
      }
    }
  }

 private:
  std::unique_ptr<asio::ip::udp::socket> socket_;
};

class ProgramsMulticastTest : public ProgramsTest, public ::testing::WithParamInterface<GroupCase> {
 protected:
  void SetUp() override {
    if (!hosts_.works())
      GTEST_SKIP() << "network namespaces are not allowed here (root and `ip netns` are needed)";
  }
  static constexpr std::uint16_t kPort = 7460, kGroupPort = 7461;

  [[nodiscard]] static const char* serverHost() {
    return GetParam().v6 ? TwoHosts::kServer6 : TwoHosts::kServer4;
  }
  [[nodiscard]] std::unique_ptr<Process> server() const {
    const GroupCase& how = GetParam();
    const std::string group = how.v6 ? "[" + std::string(how.group) + "]" : how.group;
    std::vector<std::string> command{
        HAPTICAST_SERVER_PROGRAM,
        "--source",
        "synthetic:still",
        "--loop",
        "--listen",
        (how.v6 ? "[::]:" : "0.0.0.0:") + std::to_string(kPort),
        "--multicast",
        group + ":" + std::to_string(kGroupPort) +
            (how.named ? "@" + std::string(TwoHosts::kServerLink) : "")};
    if (how.hops > 0) {
      command.insert(command.end(), {"--multicast-ttl", std::to_string(how.hops)});
    }
    return std::make_unique<Process>(TwoHosts::runOn(hosts_.server(), std::move(command)));
  }
  [[nodiscard]] std::unique_ptr<Process> client(const std::string& summary) const {
    const std::string host = GetParam().v6 ? "[" + std::string(serverHost()) + "]" : serverHost();
    std::vector<std::string> command{HAPTICAST_CLIENT_PROGRAM,
                                     host + ":" + std::to_string(kPort),
                                     "--transport",
                                     "multicast",
                                     "--device",
                                     "virtual",
                                     "--hand",
                                     "press",
                                     "--log",
                                     path("log.csv"),
                                     "--summary",
                                     summary};
    if (GetParam().named) command.insert(command.end(), {"--interface", TwoHosts::kViewerLink});
    return std::make_unique<Process>(TwoHosts::runOn(hosts_.viewer(), std::move(command)));
  }
  /// Whether the hand has pressed for a second, in which frames have come.
  [[nodiscard]] bool pressedLong() const {
    const auto rows = readLog(path("log.csv"));
    return std::count_if(rows.begin(), rows.end(), [](const LogRow& row) {
             return row.penetration_mm > 0.0 && row.force_N != Vec3::Zero();
           }) >= 1000;
  }
  /// A viewer that connects while others view: its first messages over TCP.
  CodedFrame firstFrameOfALateComer() const {
    const bool v6 = GetParam().v6;
    const auto peer = TwoHosts::madeOn(hosts_.viewer(), [&] {
      return std::make_unique<RawPeer>(
          io_, asio::ip::tcp::endpoint{asio::ip::make_address(serverHost()), kPort},
          asio::ip::make_address(v6 ? TwoHosts::kViewer6 : TwoHosts::kViewer4));
    });
    peer->send(Hello{kProtocolVersion, "late", false, true});
    const bool came = waitUntil(kSoon, [&] {
      peer->poll();
      return !peer->all<CodedFrame>().empty();
    });
    EXPECT_TRUE(came);
    return came ? peer->all<CodedFrame>().front() : CodedFrame{};
  }

  TwoHosts hosts_;
  mutable asio::io_context io_;
};

TEST_P(ProgramsMulticastTest, FramesComeByTheGroupAndGoNoFurtherThanTheyMay) {
  const GroupCase& how = GetParam();
  auto hop_counter = TwoHosts::madeOn(hosts_.viewer(), [&] {
    return std::make_unique<HopCounter>(io_, asio::ip::make_address(how.group), kGroupPort,
                                        TwoHosts::kViewerLink);
  });
  const auto server = this->server();
  ASSERT_TRUE(server->says("listening on ", kStart)) << server->output();
  const auto client = this->client(path("summary.json"));
  std::vector<int> hops;
  EXPECT_TRUE(waitUntil(kSoon,
                        [&] {
                          const auto more = hop_counter->take();
                          hops.insert(hops.end(), more.begin(), more.end());
                          return hops.size() >= 40;
                        }))
      << server->output() << client->output();
  const CodedFrame late = firstFrameOfALateComer();
  ASSERT_FALSE(late.objects.empty());
  ASSERT_TRUE(late.objects[0].relief) << "nothing changes in this scene, and yet it is whole";
  EXPECT_TRUE(late.objects[0].relief->whole());
  EXPECT_TRUE(waitUntil(kSoon, [this] { return pressedLong(); })) << client->output();
  interrupt(*client);
  interrupt(*server);
  for (const int each : hops) ASSERT_EQ(each, how.hops > 0 ? how.hops : 1);
  const auto summary = nlohmann::json::parse(std::ifstream(path("summary.json")));
  EXPECT_EQ(summary["delivery"]["way"], "multicast") << client->output();
  EXPECT_GT(summary["datagrams"]["received"], 40);
  EXPECT_GT(summary["contact_ticks"], 0);
  EXPECT_EQ(summary["step_excess_max_N"], 0.0);
}

INSTANTIATE_TEST_SUITE_P(Groups, ProgramsMulticastTest,
                         ::testing::Values(GroupCase{"V4Named", "239.255.77.9", false, true, 0},
                                           GroupCase{"V4", "239.255.77.9", false, false, 5},
                                           GroupCase{"V6OfTheSite", "ff05::7479", true, true, 0},
                                           GroupCase{"V6Transient", "ff15::7479", true, true, 5},
                                           GroupCase{"V6", "ff15::7479", true, false, 0},
                                           GroupCase{"V6OfTheLink", "ff12::7479", true, true, 0}),
                         [](const auto& at) { return at.param.name; });

}  // namespace
}  // namespace hapticast::testing
