// SPDX-License-Identifier: MIT
// Reports to the service manager that started the server: systemd with Type=notify. libsystemd
// sends a datagram to the socket in $NOTIFY_SOCKET, as sd_notify(3) describes it. Without that
// variable all functions do nothing. If the socket cannot be used, the first report logs one
// warning. Thread: see each function.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace hapticast::server {

/// Sends reports about this server to its service manager.
class ServiceManager {
 public:
  /// Reads the watchdog's period from the environment. `clock` must outlive this object.
  explicit ServiceManager(const Clock& clock);

  /// Reports that the start-up is complete. `status`: one line for `systemctl status`. A later call
  /// changes the line. Thread: any.
  void reportReady(std::string_view status);
  /// Reports that a reload has begun. End it with reportReloaded(). Thread: any.
  void reportReload();
  /// Reports that the reload has ended. Thread: any.
  void reportReloaded();
  /// Reports that the server is ending. Thread: any.
  void reportStop();
  /// Reports that the pipeline is alive, at most once in half of the watchdog's period. The service
  /// manager restarts a server that is silent for a whole period. Thread: the pipeline's.
  void reportAlive();

 private:
  void send(const std::string& text);

  const Clock& clock_;
  std::optional<Duration> interval_;  // of reportAlive(); nullopt: no watchdog
  std::optional<LocalTime> reported_alive_;
  std::atomic<bool> warned_{false};
};

}  // namespace hapticast::server
