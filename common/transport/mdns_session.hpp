// SPDX-License-Identifier: MIT
// Connection to avahi-daemon with automatic reconnection: reports to its owner when Avahi objects
// can be created and when they must be freed. Thread: Avahi's own for the events; the owner's for
// the rest.
#pragma once

#include <functional>
#include <string>

struct AvahiClient;
struct AvahiPoll;
struct AvahiThreadedPoll;
struct AvahiTimeout;

namespace hapticast {

/// One reconnecting client.
class AvahiSession {
 public:
  /// Callbacks to the owner.
  struct Events {
    std::function<void(AvahiClient*)> runs;  ///< create objects of this client
    std::function<void()> over;              ///< free these objects now, if any
    /// No daemon, with the cause; once until it runs.
    std::function<void(const std::string&)> absent;
  };

  /// Throws std::runtime_error if the library cannot start.
  explicit AvahiSession(Events events);
  /// Calls only `over`, on the calling thread, then nothing more.
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
