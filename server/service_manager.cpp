// SPDX-License-Identifier: MIT
#include "server/service_manager.hpp"

#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

/// Returns a socket that sends to `path`, or -1 with an error in errno. A path that begins with '@'
/// is a name in Linux's abstract namespace.
int connectTo(std::string_view path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path || (path[0] != '/' && path[0] != '@')) {
    errno = EINVAL;
    return -1;
  }
  path.copy(address.sun_path, path.size());
  if (path[0] == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  const int file = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (file < 0 || ::connect(file, reinterpret_cast<const sockaddr*>(&address), size) == 0)
    return file;
  const int error = errno;
  ::close(file);
  errno = error;
  return -1;
}

/// Returns half of the watchdog's period, if this process has a watchdog.
std::optional<Duration> findWatchdogInterval() {
  const char* const period = std::getenv("WATCHDOG_USEC");
  const char* const process = std::getenv("WATCHDOG_PID");
  if (period == nullptr || (process != nullptr && process != std::to_string(::getpid())))
    return std::nullopt;
  constexpr std::uint64_t kLongest_us = 1'000'000'000'000;
  const auto period_us = parseNumberInRange<std::uint64_t>(period, 1, kLongest_us);
  if (!period_us) return std::nullopt;
  return std::chrono::microseconds(*period_us / 2);
}

}  // namespace

ServiceManager::ServiceManager(const Clock& clock) : clock_(clock) {
  const char* const path = std::getenv("NOTIFY_SOCKET");
  if (path == nullptr || *path == '\0') return;
  socket_ = connectTo(path);
  if (socket_ < 0) {
    spdlog::warn("NOTIFY_SOCKET={}: {}; the service manager gets no reports", sanitizeUtf8(path),
                 std::strerror(errno));
    return;
  }
  interval_ = findWatchdogInterval();
}

ServiceManager::~ServiceManager() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceManager::reportReady(std::string_view status) const {
  send("READY=1\nSTATUS=" + sanitizeUtf8(status));
}

void ServiceManager::reportReload() const {
  const auto since_boot = clock_.now().time_since_epoch();
  const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(since_boot).count();
  send("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(now_us));
}

void ServiceManager::reportReloaded() const { send("READY=1"); }

void ServiceManager::reportStop() const { send("STOPPING=1"); }

void ServiceManager::reportAlive() {
  if (!interval_) return;
  const LocalTime now = clock_.now();
  if (reported_alive_ && now - *reported_alive_ < *interval_) return;
  reported_alive_ = now;
  send("WATCHDOG=1");
}

void ServiceManager::send(const std::string& text) const {
  // A service manager that reads nothing must not hold up the stream.
  if (socket_ >= 0) (void)::send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace hapticast::server
