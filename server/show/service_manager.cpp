// SPDX-License-Identifier: MIT
#include "server/show/service_manager.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "common/text.hpp"

namespace hapticast::server {

ServiceManager::ServiceManager(const Clock& clock) : clock_(clock) {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) interval_ = std::chrono::microseconds(period_us / 2);
}

void ServiceManager::reportReady(std::string_view status) {
  send("READY=1\nSTATUS=" + sanitizeUtf8(status));
}

void ServiceManager::reportReload() {
  const auto since_boot = clock_.now().time_since_epoch();
  const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(since_boot).count();
  send("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(now_us));
}

void ServiceManager::reportReloaded() { send("READY=1"); }

void ServiceManager::reportStop() { send("STOPPING=1"); }

void ServiceManager::reportAlive() {
  if (!interval_) return;
  const LocalTime now = clock_.now();
  if (reported_alive_ && now - *reported_alive_ < *interval_) return;
  reported_alive_ = now;
  send("WATCHDOG=1");
}

void ServiceManager::send(const std::string& text) {
  const int result = sd_notify(0, text.c_str());
  if (result >= 0 || warned_.exchange(true)) return;
  spdlog::warn("NOTIFY_SOCKET={}: {}; the service manager gets no reports",
               sanitizeUtf8(std::getenv("NOTIFY_SOCKET")), std::strerror(-result));
}

}  // namespace hapticast::server
