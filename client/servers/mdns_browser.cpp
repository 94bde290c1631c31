// SPDX-License-Identifier: MIT
#if HAPTICAST_AVAHI
#include "client/servers/mdns_browser.hpp"

#include <avahi-client/lookup.h>
#include <avahi-common/error.h>
#include <net/if.h>

#include <array>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "common/mdns.hpp"
#include "common/text.hpp"
#include "common/transport/mdns_session.hpp"

namespace hapticast::client {

namespace {

// Chosen: a server comes once for each network and version of IP, and a stranger may announce any
// number of them.
constexpr std::size_t kMostEntries = 128;

/// What a TXT record has under this key; empty without it.
std::string readValue(AvahiStringList* record, const std::string& key) {
  const AvahiStringList* const item = avahi_string_list_find(record, key.c_str());
  if (item == nullptr) return "";
  const auto* const bytes = reinterpret_cast<const char*>(item->text);
  const std::string text(bytes, item->size);
  return text.size() > key.size() ? text.substr(key.size() + 1) : "";
}

std::string formatName(AvahiIfIndex network) {
  std::array<char, IF_NAMESIZE> name{};
  const bool known = ::if_indextoname(static_cast<unsigned>(network), name.data()) != nullptr;
  return known ? name.data() : std::to_string(network);
}

Endpoint resolveEndpoint(const AvahiAddress& address, std::uint16_t port,
                         const std::string& network) {
  std::array<char, AVAHI_ADDRESS_STR_MAX> text{};
  avahi_address_snprint(text.data(), text.size(), &address);
  std::string host = text.data();
  // Such an address means something on its own network only.
  if (address.proto == AVAHI_PROTO_INET6 && host.starts_with("fe80:")) host.append("%" + network);
  return {host, port};
}

}  // namespace

/// On the library's thread, but for what the mutex guards.
struct Discovery::Browser {
  /// A service on one network by one version of IP.
  using Key = std::tuple<AvahiIfIndex, AvahiProtocol, std::string, std::string>;

  void start(AvahiClient* client) {
    const auto came = [](AvahiServiceBrowser*, AvahiIfIndex network, AvahiProtocol protocol,
                         AvahiBrowserEvent event, const char* name, const char*, const char* domain,
                         AvahiLookupResultFlags, void* self) {
      auto& browser = *static_cast<Browser*>(self);
      if (event == AVAHI_BROWSER_NEW) browser.add({network, protocol, name, domain});
      if (event == AVAHI_BROWSER_REMOVE) browser.remove({network, protocol, name, domain});
    };
    {
      const std::lock_guard lock(mutex);
      absence.clear();
    }
    avahi = client;
    services = avahi_service_browser_new(client, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC, kServiceType,
                                         nullptr, static_cast<AvahiLookupFlags>(0), came, this);
    if (services == nullptr) onRemoved(avahi_strerror(avahi_client_errno(client)));
  }

  void add(const Key& key) {
    if (resolvers.size() >= kMostEntries || resolvers.contains(key)) return;
    const auto& [network, protocol, name, domain] = key;
    const auto resolved = [](AvahiServiceResolver* resolver, AvahiIfIndex on, AvahiProtocol,
                             AvahiResolverEvent event, const char* service, const char*,
                             const char*, const char* host, const AvahiAddress* address,
                             std::uint16_t port, AvahiStringList* record, AvahiLookupResultFlags,
                             void* self) {
      std::optional<FoundServer> server;
      if (event == AVAHI_RESOLVER_FOUND && address != nullptr && port != 0) {
        const std::string where = formatName(on);
        server = {
            service,
            host,
            resolveEndpoint(*address, port, where),
            where,
            readValue(record, kTxtTitleKey),
            static_cast<std::uint32_t>(parseNumberInRange<std::uint16_t>(
                                           readValue(record, kServiceVersionKey), 0, UINT16_MAX)
                                           .value_or(0)),
            readValue(record, kTxtTlsKey)};
      }
      static_cast<Browser*>(self)->onFound(resolver, std::move(server));
    };
    AvahiServiceResolver* const resolver = avahi_service_resolver_new(
        avahi, network, protocol, name.c_str(), kServiceType, domain.c_str(), protocol,
        static_cast<AvahiLookupFlags>(0), resolved, this);
    if (resolver != nullptr) resolvers.emplace(key, resolver);
  }

  void onFound(AvahiServiceResolver* resolver, std::optional<FoundServer> server) {
    const std::lock_guard lock(mutex);
    if (server) {
      found[resolver] = std::move(*server);
    } else {
      found.erase(resolver);
    }
  }

  void remove(const Key& key) {
    const auto entry = resolvers.find(key);
    if (entry == resolvers.end()) return;
    onFound(entry->second, std::nullopt);
    avahi_service_resolver_free(entry->second);
    resolvers.erase(entry);
  }

  void forget() {
    while (!resolvers.empty()) remove(Key(resolvers.begin()->first));
    if (services != nullptr) avahi_service_browser_free(services);
    services = nullptr;
  }

  void onRemoved(const std::string& why) {
    const std::lock_guard lock(mutex);
    absence = why;
  }

  AvahiClient* avahi = nullptr;
  AvahiServiceBrowser* services = nullptr;
  std::map<Key, AvahiServiceResolver*> resolvers;
  mutable std::mutex mutex;
  std::map<AvahiServiceResolver*, FoundServer> found;  // mutex
  std::string absence;                                 // mutex
  AvahiSession session{{.runs = [this](AvahiClient* client) { start(client); },
                        .over = [this] { forget(); },
                        .onAbsent = [this](const std::string& why) { onRemoved(why); }}};
};

Discovery::Discovery() : browser_(std::make_unique<Browser>()) {}
Discovery::~Discovery() = default;

std::vector<FoundServer> Discovery::servers() const {
  std::vector<FoundServer> all;
  {
    const std::lock_guard lock(browser_->mutex);
    all.reserve(browser_->found.size());
    for (const auto& each : browser_->found) all.push_back(each.second);
  }
  return removeDuplicates(std::move(all));
}

std::string Discovery::describeAbsence() const {
  const std::lock_guard lock(browser_->mutex);
  return browser_->absence;
}

}  // namespace hapticast::client

#else
#include "client/servers/mdns_browser.hpp"

namespace hapticast::client {

struct Discovery::Browser {};

Discovery::Discovery() = default;
Discovery::~Discovery() = default;
std::vector<FoundServer> Discovery::servers() const { return {}; }
std::string Discovery::describeAbsence() const { return "this build has no Avahi"; }

}  // namespace hapticast::client
#endif  // HAPTICAST_AVAHI
