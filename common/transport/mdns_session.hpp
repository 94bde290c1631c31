// SPDX-License-Identifier: MIT
// Connection to avahi-daemon, which reconnects automatically. The owner creates objects of the
// Avahi library. This class calls it when it can create them, and when it must free them. Thread:
// Avahi's own for the events; the owner's for the rest.
#pragma once

#include <functional>
#include <string>

struct AvahiClient;
struct AvahiPoll;
struct AvahiThreadedPoll;
struct AvahiTimeout;

namespace hapticast {

/// A client of avahi-daemon that reconnects.
class AvahiSession {
 public:
  /// Callbacks that the owner implements.
  struct Events {
    std::function<void(AvahiClient*)> runs;  ///< the daemon runs: create objects of this client
    std::function<void()> over;              ///< free these objects now, if there are any
    /// No daemon runs; the argument is the cause. It is called only once, until the daemon runs
    /// again.
    std::function<void(const std::string&)> absent;
  };

  /// Starts to connect. Throws std::runtime_error if the library cannot start.
  explicit AvahiSession(Events events);
  /// Ends the connection. It calls `over` in the calling thread, and no other callback after that.
  ~AvahiSession();
  AvahiSession(const AvahiSession&) = delete;
  AvahiSession& operator=(const AvahiSession&) = delete;

 private:
  static void changed(AvahiClient* client, int state, void* self);
  void connect();
  void disconnect();
  void lost(const std::string& why);
  void retryLater();

  Events events_;
  AvahiThreadedPoll* poll_;
  const AvahiPoll* api_;
  AvahiClient* client_ = nullptr;
  AvahiTimeout* retry_ = nullptr;
  bool logged_absent_ = false;
};

}  // namespace hapticast
