// SPDX-License-Identifier: MIT
#if HAPTICAST_AVAHI
#include "server/stream/announce.hpp"

#include <avahi-client/publish.h>
#include <avahi-common/alternative.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "common/mdns.hpp"
#include "common/protocol/messages.hpp"
#include "common/rate_limiter.hpp"
#include "common/transport/mdns_session.hpp"
#include "common/transport/network_interfaces.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

namespace {

/// Returns the network from which a server at `address` is reachable. Returns all networks if the
/// server listens at all addresses, or if `address` no longer belongs to this machine.
AvahiIfIndex findNetwork(const asio::ip::address& address) {
  const auto all = networkInterfaces();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& each) { return each.address == address; });
  return found == all.end() ? AVAHI_IF_UNSPEC : static_cast<AvahiIfIndex>(found->index);
}

/// Returns the IP version to announce. A server that listens at all IPv6 addresses also accepts
/// IPv4.
AvahiProtocol toAvahiProtocol(const asio::ip::address& address) {
  if (address.is_v4()) return AVAHI_PROTO_INET;
  return address.is_unspecified() ? AVAHI_PROTO_UNSPEC : AVAHI_PROTO_INET6;
}

std::string toText(const char* key, const std::string& value) {
  return std::string(key) + "=" + value;
}

}  // namespace

void requireReachable(const asio::ip::address& address) {
  if (!address.is_loopback()) return;
  throw AddressError("--announce: nobody else can reach a server on " + address.to_string() +
                     "; --listen names another address");
}

/// State of the announcement. Avahi's thread uses it as soon as `session` has begun.
struct Announcer::Service {
  Service(std::string the_name, const asio::ip::tcp::endpoint& where, const std::string& what,
          const std::string& fingerprint, bool page)
      : wanted(std::move(the_name)),
        name(wanted),
        listen_endpoint(where),
        version(toText(kServiceVersionKey, std::to_string(kProtocolVersion))),
        stream_name(toText(kTxtTitleKey, sanitizeUtf8(what, kMaxServicePlays_bytes))),
        tls(fingerprint.empty() ? "" : toText(kTxtTlsKey, fingerprint)),
        has_page(page) {}

  void make(AvahiClient* client) {
    const auto settled = [](AvahiEntryGroup*, AvahiEntryGroupState state, void* self) {
      static_cast<Service*>(self)->changed(state);
    };
    name = wanted;
    group = avahi_entry_group_new(client, settled, this);
    if (group == nullptr) {
      logFailure(avahi_client_errno(client));
      return;
    }
    publish();
  }

  void publish() {
    int error = 0;
    // Avahi reports a name of another program on this machine at once.
    while ((error = addAll()) == AVAHI_ERR_COLLISION) {
      rename();
      avahi_entry_group_reset(group);
    }
    if (error == AVAHI_OK) error = avahi_entry_group_commit(group);
    if (error != AVAHI_OK) logFailure(error);
  }

  /// Adds the service for viewers and the web site to the group. Returns the error of Avahi.
  int addAll() {
    std::vector<const char*> txt{version.c_str(), stream_name.c_str()};
    if (!tls.empty()) txt.push_back(tls.c_str());
    const int error = add(kServiceType, txt);
    if (error != AVAHI_OK || !has_page) return error;
    return add(tls.empty() ? kWebServiceType : kTlsWebServiceType, {kWebServicePath});
  }

  int add(const char* type, std::vector<const char*> txt) {
    const std::unique_ptr<AvahiStringList, decltype(&avahi_string_list_free)> list(
        avahi_string_list_new_from_array(txt.data(), static_cast<int>(txt.size())),
        &avahi_string_list_free);
    return avahi_entry_group_add_service_strlst(
        group, findNetwork(listen_endpoint.address()), toAvahiProtocol(listen_endpoint.address()),
        static_cast<AvahiPublishFlags>(0), name.c_str(), type, nullptr, nullptr,
        listen_endpoint.port(), list.get());
  }

  void rename() {
    char* const other = avahi_alternative_service_name(name.c_str());
    name = other;
    avahi_free(other);
  }

  void changed(AvahiEntryGroupState state) {
    if (state == AVAHI_ENTRY_GROUP_ESTABLISHED) {
      if (!limit.allow(SteadyClock().now())) return;
      spdlog::info("announced on the LAN as {}{}", name,
                   name == wanted ? "" : " (another server has the name " + wanted + ")");
    } else if (state == AVAHI_ENTRY_GROUP_COLLISION && group != nullptr) {
      rename();
      avahi_entry_group_reset(group);
      publish();
    } else if (state == AVAHI_ENTRY_GROUP_FAILURE && group != nullptr) {
      logFailure(avahi_client_errno(avahi_entry_group_get_client(group)));
    }
  }

  static void logFailure(int error) {
    spdlog::warn("not announced on the LAN: {}", avahi_strerror(error));
  }

  void withdraw() {
    if (group != nullptr) avahi_entry_group_free(group);
    group = nullptr;
  }

  const std::string wanted;
  std::string name;  // as it is announced
  const asio::ip::tcp::endpoint listen_endpoint;
  const std::string version;
  const std::string stream_name;
  const std::string tls;
  const bool has_page;
  RateLimiter limit;  // a host may claim each name again and again
  AvahiEntryGroup* group = nullptr;
  AvahiSession session{
      {.runs = [this](AvahiClient* client) { make(client); },
       .over = [this] { withdraw(); },
       .onAbsent =
           [](const std::string& why) {
             spdlog::warn("not announced on the LAN: {}; the server tries again automatically",
                          why);
           }}};
};

Announcer::Announcer(std::string name, const asio::ip::tcp::endpoint& listen_endpoint,
                     const std::string& stream_name, const std::string& tls_fingerprint,
                     bool has_page)
    : service_(std::make_unique<Service>(std::move(name), listen_endpoint, stream_name,
                                         tls_fingerprint, has_page)) {}

Announcer::~Announcer() = default;

}  // namespace hapticast::server

#else
#include "server/stream/announce.hpp"

namespace hapticast::server {

struct Announcer::Service {};

void requireReachable(const asio::ip::address& /*address*/) {}

Announcer::Announcer(std::string /*name*/, const asio::ip::tcp::endpoint& /*listens*/,
                     const std::string& /*plays*/, const std::string& /*tls_fingerprint*/,
                     bool /*has_page*/) {}

Announcer::~Announcer() = default;

}  // namespace hapticast::server
#endif  // HAPTICAST_AVAHI
