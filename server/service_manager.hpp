// SPDX-License-Identifier: MIT
// Reports to the service manager that started the server: systemd with Type=notify. The protocol is
// a datagram to the socket in $NOTIFY_SOCKET, as sd_notify(3) describes it. Without that variable
// all functions do nothing. Thread: see each function.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace hapticast::server {

/// Connection to the service manager.
class ServiceManager {
 public:
  /// Connects as the environment states. Logs one warning if the socket cannot be used. `clock`
  /// must outlive this object.
  explicit ServiceManager(const Clock& clock);
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// Reports that the start-up is complete. `status`: one line for `systemctl status`. A later call
  /// changes the line. Thread: any.
  void reportReady(std::string_view status) const;
  /// Reports that a reload has begun. End it with reportReloaded(). Thread: any.
  void reportReload() const;
  /// Reports the end of a reload. Thread: any.
  void reportReloaded() const;
  /// Reports that the server is ending. Thread: any.
  void reportStop() const;
  /// Reports that the pipeline is alive, at most once in half of the watchdog's period. The service
  /// manager restarts a server that is silent for a whole period. Thread: the pipeline's.
  void reportAlive();

 private:
  void send(const std::string& text) const;

  const Clock& clock_;
  int socket_ = -1;                   // -1: no service manager
  std::optional<Duration> interval_;  // of reportAlive(); nullopt: no watchdog
  std::optional<LocalTime> reported_alive_;
};

}  // namespace hapticast::server
