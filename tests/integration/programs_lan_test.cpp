// SPDX-License-Identifier: MIT
// Both programs on two hosts (network namespaces) with a cable between them, and the real
// avahi-daemon on a message bus of each host's own: a server is announced, found and listed.
#include <cstdlib>

#include "common/build_options.hpp"
#include "common/cli/parse.hpp"
#include "server/page/page_files.hpp"
#include "tests/integration/programs_fixture.hpp"
#include "tests/support/installed.hpp"
#include "tests/support/two_hosts.hpp"

namespace hapticast::testing {
namespace {

constexpr const char* kName = "Küche \xF0\x9F\x8F\x80";

class ProgramsLanTest : public ProgramsTest {
 protected:
  void SetUp() override {
    if (!kHasDiscovery) GTEST_SKIP() << "this build has no Avahi";
    for (const char* program : {"dbus-daemon", "avahi-daemon", "unshare"}) {
      if (!isInstalled(program)) GTEST_SKIP() << "there is no " << program;
    }
    if (!hosts_.works()) GTEST_SKIP() << "network namespaces (root, ip netns) are not allowed here";
    for (const std::string& host : {hosts_.server(), hosts_.viewer()}) {
      buses_.push_back(startBus(host));
      if (!waitUntil(kSoon, [&] { return std::filesystem::exists(busOf(host)); }))
        GTEST_SKIP() << "no message bus can be run here: " << buses_.back()->output();
    }
    daemons_.push_back(startDaemon(hosts_.server()));
    daemons_.push_back(startDaemon(hosts_.viewer()));
    for (const auto& daemon : daemons_) {
      if (!daemon->says("Server startup complete", kSoon))
        GTEST_SKIP() << "avahi-daemon cannot run here: " << daemon->output();
    }
  }

  [[nodiscard]] std::string busOf(const std::string& host) const { return path(host + ".bus"); }
  [[nodiscard]] std::unique_ptr<Process> startBus(const std::string& host) const {
    const std::string file = write(
        host + ".conf",
        "<busconfig><listen>unix:path=" + busOf(host) +
            "</listen><auth>EXTERNAL</auth><policy context=\"default\"><allow user=\"*\"/>"
            "<allow own=\"*\"/><allow send_type=\"method_call\"/><allow send_destination=\"*\"/>"
            "<allow receive_sender=\"*\"/></policy></busconfig>");
    return start("/usr/bin/env", {"dbus-daemon", "--nofork", "--config-file=" + file});
  }
  [[nodiscard]] std::unique_ptr<Process> startDaemon(const std::string& host) const {
    const std::string file = write(host + ".avahi", "[server]\nhost-name=" + host + "\n");
    // Where it keeps its own number is fixed, so each has a folder of its own there.
    return run(host, {"/usr/bin/env", "unshare", "-m", "sh", "-c",
                      "mkdir -p /run/avahi-daemon && mount -t tmpfs tmpfs /run/avahi-daemon && "
                      "exec avahi-daemon --no-drop-root --no-chroot --no-rlimits --no-proc-title "
                      "-f " +
                          file});
  }
  /// A program on that host, which finds that host's bus.
  [[nodiscard]] std::unique_ptr<Process> run(const std::string& host,
                                             std::vector<std::string> command) const {
    return std::make_unique<Process>(onHost(host, std::move(command)));
  }
  [[nodiscard]] std::vector<std::string> onHost(const std::string& host,
                                                std::vector<std::string> command) const {
    const std::string bus = "DBUS_SYSTEM_BUS_ADDRESS=unix:path=" + busOf(host);
    command.insert(command.begin(), {"/usr/bin/env", bus});
    return TwoHosts::runOn(host, std::move(command));
  }
  [[nodiscard]] std::unique_ptr<Process> announce(const std::string& host, const std::string& name,
                                                  const std::string& plays = "clip") const {
    return run(host, {HAPTICAST_SERVER_PROGRAM, "--source", clip_, "--loop", "--listen", "0",
                      "--announce", name, "--name", plays});
  }
  /// What --list of the viewer's host says, as soon as it has all of these.
  std::string listed(const std::vector<std::string>& all) const {
    std::string text;
    EXPECT_TRUE(waitUntil(kSoon, [&] {
      const auto list = run(hosts_.viewer(), {HAPTICAST_CLIENT_PROGRAM, "--list"});
      EXPECT_NE(list->wait(kSoon), std::nullopt);
      text = list->output();
      return std::all_of(all.begin(), all.end(),
                         [&](const auto& each) { return text.find(each) != std::string::npos; });
    })) << text;
    return text;
  }

  const std::string clip_ = makeClip("clip");
  TwoHosts hosts_;
  std::vector<std::unique_ptr<Process>> buses_;
  std::vector<std::unique_ptr<Process>> daemons_;  // of the server's host, of the viewer's
};

TEST_F(ProgramsLanTest, ATakenNameGetsANumberAndAllAreListedClean) {
  const auto none = run(hosts_.viewer(), {HAPTICAST_CLIENT_PROGRAM, "--list"});
  EXPECT_EQ(none->wait(kSoon), 1);
  EXPECT_TRUE(none->output().ends_with(" error no server is announced on the LAN\n"))
      << none->output();

  const auto first = announce(hosts_.server(), kName, "red \x1b[31m");
  ASSERT_TRUE(first->says(std::string("announced on the LAN as ") + kName + "\n", kSoon))
      << first->output();
  const auto beside = announce(hosts_.server(), kName);
  ASSERT_TRUE(beside->says(std::string(kName) + " #2 (another server has the name ", kSoon))
      << beside->output();
  const auto elsewhere = announce(hosts_.viewer(), kName);
  ASSERT_TRUE(elsewhere->says(std::string(kName) + " #3 (another server has the name ", kSoon))
      << elsewhere->output();

  const std::string all = listed({std::string(kName) + "  at ", " #2  at ", " #3  at "});
  EXPECT_EQ(countOccurrences("\n", all), 3U) << all;
  EXPECT_NE(all.find("plays red ?[31m"), std::string::npos) << all;
  EXPECT_EQ(countOccurrences("\x1b", all), 0U) << all;
  EXPECT_NE(all.find(TwoHosts::kServer4), std::string::npos) << all;
  EXPECT_NE(all.find(TwoHosts::kViewerLink), std::string::npos) << all;

  interrupt(*first);  // which withdraws it
  interrupt(*beside);
  interrupt(*elsewhere);
  listed({"no server is announced"});
}

TEST_F(ProgramsLanTest, ThePageIsListedAsAWebSite) {
  if (!server::isPageComplete()) GTEST_SKIP() << "this build has no page";
  if (!isInstalled("avahi-browse")) GTEST_SKIP() << "no avahi-browse";
  const auto first = announce(hosts_.server(), kName);
  ASSERT_TRUE(first->says(std::string("announced on the LAN as ") + kName + "\n", kSoon))
      << first->output();
  const auto second = announce(hosts_.server(), kName);
  ASSERT_TRUE(second->says(std::string(kName) + " #2 (another server has the name ", kSoon))
      << second->output();
  std::string text;
  EXPECT_TRUE(waitUntil(kSoon, [&] {
    const auto list = run(hosts_.viewer(), {"/usr/bin/env", "avahi-browse", "-rpt", "_http._tcp"});
    EXPECT_NE(list->wait(kSoon), std::nullopt);
    text = list->output();
    return text.find("\\0352;Web Site;") != std::string::npos &&  // "#2" with avahi's escapes
           text.find("\"path=/\"") != std::string::npos;
  })) << text;
  interrupt(*second);
  interrupt(*first);
}

TEST_F(ProgramsLanTest, AServerIsFoundByNameAndNeverUsedUnnamed) {
  const auto named = run(hosts_.viewer(), {HAPTICAST_CLIENT_PROGRAM, std::string("mdns:") + kName});
  ASSERT_TRUE(named->says("(no server announces this name)", kSoon)) << named->output();
  const auto alone = run(hosts_.viewer(), {HAPTICAST_CLIENT_PROGRAM});
  ASSERT_TRUE(alone->says("waiting for a server at localhost:7447", kSoon)) << alone->output();
  const auto server = announce(hosts_.server(), kName);
  ASSERT_TRUE(named->says("connected: clip", kSoon)) << named->output();
  ASSERT_TRUE(
      alone->says("servers on the LAN (HOST:PORT or mdns:NAME as argument selects one)", kSoon))
      << alone->output();
  EXPECT_TRUE(alone->says(std::string(kName) + "  at ", kSoon)) << alone->output();
  EXPECT_EQ(countOccurrences("connected: ", alone->output()), 0U) << alone->output();
  interrupt(*alone);
  interrupt(*named);
  interrupt(*server);
}

TEST_F(ProgramsLanTest, AnnouncesAgainAfterTheDaemonComesBack) {
  const std::string announced = std::string("announced on the LAN as ") + kName;
  const auto server = announce(hosts_.server(), kName);
  ASSERT_TRUE(server->says(announced, kSoon)) << server->output();
  interrupt(*daemons_[0], SIGTERM);
  EXPECT_TRUE(server->says("not announced on the LAN: avahi-daemon does not run", kSoon))
      << server->output();
  listed({"no server is announced"});
  daemons_[0] = startDaemon(hosts_.server());
  EXPECT_TRUE(server->says(announced + "\n", kSoon, 2)) << server->output();
  listed({kName});

  interrupt(*daemons_[1], SIGTERM);
  listed({"no search for servers on the LAN: avahi-daemon does not run; start it (sudo systemctl"});
  buses_.clear();  // not even a bus any more
  listed({"no search for servers on the LAN: avahi-daemon cannot be reached", "; start it ("});
  const auto named = run(hosts_.viewer(), {HAPTICAST_CLIENT_PROGRAM, std::string("mdns:") + kName});
  EXPECT_TRUE(named->says("avahi-daemon cannot be reached", kSoon)) << named->output();
  interrupt(*named);
  EXPECT_TRUE(server->says("not announced on the LAN", kSoon, 2)) << server->output();
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
