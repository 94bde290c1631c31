// SPDX-License-Identifier: MIT
#if HAPTICAST_AVAHI
#include "common/transport/mdns_session.hpp"

#include <avahi-client/client.h>
#include <avahi-common/error.h>
#include <avahi-common/thread-watch.h>
#include <avahi-common/timeval.h>

#include <stdexcept>
#include <utility>

namespace hapticast {

namespace {
constexpr unsigned kRetry_ms = 2000;  // chosen: a restarted daemon is soon back
constexpr const char* kNoDaemon =
    "avahi-daemon does not run; start it (sudo systemctl start avahi-daemon)";
}  // namespace

AvahiSession::AvahiSession(Events events)
    : events_(std::move(events)), poll_(avahi_threaded_poll_new()) {
  if (poll_ == nullptr) throw std::runtime_error("Avahi's client library cannot start");
  api_ = avahi_threaded_poll_get(poll_);
  connect();
  avahi_threaded_poll_start(poll_);
}

AvahiSession::~AvahiSession() {
  avahi_threaded_poll_stop(poll_);
  disconnect();
  if (retry_ != nullptr) api_->timeout_free(retry_);
  avahi_threaded_poll_free(poll_);
}

void AvahiSession::connect() {
  int error = 0;
  // The library passes its own enumeration, whose values fit an int.
  client_ = avahi_client_new(
      api_, AVAHI_CLIENT_NO_FAIL,
      [](AvahiClient* client, AvahiClientState state, void* self) { changed(client, state, self); },
      this, &error);
  if (client_ != nullptr) return;
  lost(std::string("avahi-daemon cannot be reached (") + avahi_strerror(error) +
       "); start it (sudo systemctl start avahi-daemon)");
  retryLater();
}

void AvahiSession::disconnect() {
  events_.over();
  if (client_ != nullptr) avahi_client_free(client_);
  client_ = nullptr;
}

void AvahiSession::changed(AvahiClient* client, int state, void* self) {
  auto& session = *static_cast<AvahiSession*>(self);
  switch (state) {
    case AVAHI_CLIENT_S_RUNNING:
      session.logged_absent_ = false;
      session.events_.over();
      session.events_.runs(client);
      break;
    case AVAHI_CLIENT_CONNECTING:
      session.lost(kNoDaemon);
      break;
    case AVAHI_CLIENT_FAILURE: {
      const int error = avahi_client_errno(client);
      session.lost(error == AVAHI_ERR_DISCONNECTED ? kNoDaemon : avahi_strerror(error));
      session.retryLater();  // a failed client is unusable
      break;
    }
    default:  // the machine's name is changing, which removes published services
      session.events_.over();
  }
}

void AvahiSession::lost(const std::string& why) {
  events_.over();
  if (!std::exchange(logged_absent_, true)) events_.onAbsent(why);
}

void AvahiSession::retryLater() {
  timeval when{};
  avahi_elapse_time(&when, kRetry_ms, 0);
  if (retry_ != nullptr) {
    api_->timeout_update(retry_, &when);
    return;
  }
  const auto again = [](AvahiTimeout* timer, void* self) {
    auto& session = *static_cast<AvahiSession*>(self);
    session.api_->timeout_update(timer, nullptr);
    session.disconnect();
    session.connect();
  };
  retry_ = api_->timeout_new(api_, &when, again, this);
}

}  // namespace hapticast

#endif  // HAPTICAST_AVAHI
