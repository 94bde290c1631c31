// SPDX-License-Identifier: MIT
// A client of avahi-daemon that outlives the daemon: whenever that is there, its owner is told to
// make his objects, and when it goes to free them. Thread: a library's own, on which the events
// come; the owner's for the rest.
#pragma once

#include <functional>
#include <string>

struct AvahiClient;
struct AvahiPoll;
struct AvahiThreadedPoll;
struct AvahiTimeout;

namespace hapticast {

class AvahiSession {
 public:
  struct Events {
    std::function<void(AvahiClient*)> runs;  ///< objects of this client can be made
    std::function<void()> over;              ///< they have to be freed now, if there are any
    std::function<void(const std::string&)> absent;  ///< why there is none, once until it runs
  };

  /// Throws std::runtime_error where the library cannot begin.
  explicit AvahiSession(Events events);
  /// Nothing is called any more but `over`, on the calling thread.
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
