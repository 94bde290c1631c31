// SPDX-License-Identifier: MIT
// Connection to avahi-daemon, which reconnects automatically. The owner of the session creates
// objects of the Avahi library. The session calls the owner's callbacks when these objects can be
// created, and when they must be freed. Thread: Avahi's own for the callbacks; the owner's for all
// other functions.
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
    /// The daemon runs: the owner can create objects of this client.
    std::function<void(AvahiClient*)> runs;
    /// The owner must free these objects now, if there are any.
    std::function<void()> over;
    /// No daemon runs; the argument is the cause. The session calls it once for each absence of the
    /// daemon.
    std::function<void(const std::string&)> onAbsent;
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
