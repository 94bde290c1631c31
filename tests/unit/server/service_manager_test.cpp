// SPDX-License-Identifier: MIT
#include "server/show/service_manager.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>

#include "tests/support/log_lines.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {
namespace {

/// The socket of a service manager, and the variables that name it.
class Manager {
 public:
  explicit Manager(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path);
    if (path[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0) << path;
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  ~Manager() {
    ::close(socket_);
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// The next message; empty if there is none.
  [[nodiscard]] std::string read() const {
    std::array<char, 1024> text{};
    const auto size = ::recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
    return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "";
  }

 private:
  int socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

std::string abstractName() { return "@hapticast_test_" + std::to_string(::getpid()); }

TEST(ServiceManager, ReportsGoToTheSocketOfTheEnvironment) {
  const TempFolder folder;
  for (const std::string& path : {(folder / "notify").string(), abstractName()}) {
    const Manager manager(path);
    ManualClock clock;
    clock.set(localTime(1.5));
    ServiceManager service(clock);
    service.reportReady("ball: listening\non 7447");
    service.reportReload();
    service.reportReloaded();
    service.reportStop();
    EXPECT_EQ(manager.read(), "READY=1\nSTATUS=ball: listening?on 7447") << path;
    EXPECT_EQ(manager.read(), "RELOADING=1\nMONOTONIC_USEC=1500000");
    EXPECT_EQ(manager.read(), "READY=1");
    EXPECT_EQ(manager.read(), "STOPPING=1");
    EXPECT_EQ(manager.read(), "");
  }
}

TEST(ServiceManager, TheWatchdogIsNotifiedTwiceInItsPeriod) {
  const Manager manager(abstractName());
  ::setenv("WATCHDOG_USEC", "2000000", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  ManualClock clock;
  ServiceManager service(clock);
  int reports = 0;
  for (int i = 0; i < 100; ++i) {  // 2 s
    service.reportAlive();
    const std::string text = manager.read();
    EXPECT_TRUE(text.empty() || text == "WATCHDOG=1") << text;
    reports += text.empty() ? 0 : 1;
    clock.advance(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(reports, 2);
}

TEST(ServiceManager, SendsNothingToAnotherProcessesWatchdog) {
  const Manager manager(abstractName());
  const ManualClock clock;
  ServiceManager(clock).reportAlive();
  ::setenv("WATCHDOG_USEC", "2000000", 1);
  ::setenv("WATCHDOG_PID", "1", 1);
  ServiceManager(clock).reportAlive();
  EXPECT_EQ(manager.read(), "");
}

TEST(ServiceManager, ASocketThatCannotBeUsedIsOneWarning) {
  const ManualClock clock;
  for (const char* path : {"relative", "/nowhere/notify"}) {
    ::setenv("NOTIFY_SOCKET", path, 1);
    const LogLines log;
    ServiceManager(clock).reportReady("");
    EXPECT_EQ(log.count(), 1) << log.text();
    EXPECT_NE(log.text().find(path), std::string::npos) << log.text();
  }
  ::unsetenv("NOTIFY_SOCKET");
  const LogLines log;
  ServiceManager(clock).reportReady("");
  EXPECT_EQ(log.text(), "");
}

}  // namespace
}  // namespace hapticast::server
