// SPDX-License-Identifier: MIT
#include "server/settings/network_options.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"

namespace hapticast::server {

namespace {

const std::map<std::string, bool> kTransports{{"udp", true}, {"tcp", false}};
const std::map<std::string, bool> kSwitch{{"on", true}, {"off", false}};

void addMulticast(CLI::App& app, std::optional<MulticastChoice>& multicast) {
  constexpr const char* kForm = "GROUP:PORT[@INTERFACE], for example 239.1.2.3:7448";
  const auto set = [&multicast](const std::string& text) {
    const std::size_t at = text.find('@');
    const auto group = parseEndpoint(text.substr(0, at), Endpoint{"", 0});
    const bool named = at == std::string::npos || at + 1 < text.size();
    if (!group || group->host.empty() || group->port == 0 || !named)
      throw CLI::ValidationError("--multicast", quote(text) + " is not " + kForm);
    multicast = MulticastChoice{*group, at == std::string::npos ? "" : text.substr(at + 1)};
  };
  app.add_option_function<std::string>(
         "--multicast", set,
         "Send each datagram once to this group, for all viewers of a network that join it; "
         "INTERFACE is a name or an address of this machine")
      ->type_name("GROUP:PORT[@INTERFACE]");
}

void addTlsOptions(CLI::App& app, Settings& settings) {
  app.add_option("--tls-cert", settings.tls.certificate,
                 "Offer TLS with this certificate (PEM, with its chain); needs --tls-key")
      ->type_name("FILE");
  app.add_option("--tls-key", settings.tls.key, "The private key of --tls-cert (PEM)")
      ->type_name("FILE");
  const auto set = [&settings](const std::string& text) {
    if (text != "auto") throw CLI::ValidationError("--tls", quote(text) + " is not auto");
    settings.tls.automatic = true;
  };
  app.add_option_function<std::string>(
         "--tls", set,
         "auto: offer TLS with a key pair of the server's own, which it makes once; the log shows "
         "its fingerprint, and --announce carries it")
      ->type_name("auto");
  app.add_option("--tokens", settings.tokens_file,
                 "Accept only viewers with a token of this file: lines `SHA256 viewer|operator "
                 "YYYY-MM-DD|never`; other machines then need TLS")
      ->type_name("FILE");
  app.add_flag("--insecure", settings.insecure,
               "With --tokens: accept other machines without TLS, so that anybody on the way can "
               "read their tokens");
}

/// Returns `text` if it has only characters that occur in host names.
std::optional<std::string> parseHostName(const std::string& text) {
  constexpr std::size_t kLongest_bytes = 253;
  const bool valid = std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_';
  });
  if (!valid || text.empty() || text.size() > kLongest_bytes) return std::nullopt;
  return text;
}

void addHttp(CLI::App& app, Settings& settings) {
  addLocalPort(
      app, "--http", settings.http,
      "Show figures for operators by HTTP: /metrics (Prometheus), /health, /status.json; ADDR: "
      "an IP address of this machine, default: 127.0.0.1; port 0: any free port; without this "
      "flag: no such port");
  addList(
      app, "--host-name", settings.host_names, parseHostName,
      "Another name under which browsers and requests may reach the page and the port of --http, "
      "for example of a reverse proxy; repeat for several. Addresses, localhost and the name of "
      "this machine need no flag",
      "NAME (a host name without a port, such as figures.example.org)");
}

std::optional<KeyBytes> parseOriginKey(const std::string& text) { return parseKey(text); }

void addOriginKey(CLI::App& app, std::vector<KeyBytes>& keys) {
  addList(
      app, "--origin-key", keys, parseOriginKey,
      "A public key that the origin of this edge may have, or the other origins of the channel; "
      "repeat for several. Default: any key, but with --signing-key only its own",
      "KEY (64 hex digits of the origin's public key)");
}

}  // namespace

void addNetworkOptions(CLI::App& app, Settings& settings) {
  addEndpoint(app, "--listen", settings.listen, 0, "[ADDR:]PORT, an IP address or [V6ADDRESS]:PORT",
              "The address for clients: an IP address of this machine and a port; default: "
              "[::]:7447 (all addresses of IPv6 and IPv4); port 0: any free port");
  addChoice(app, "--transport", settings.datagrams, kTransports,
            "udp: the server sends frames by UDP to viewers that can receive them, else by TCP; "
            "tcp: all frames by TCP. Default: udp");
  addChoice(app, "--page", settings.page, kSwitch,
            "on: the address for clients also shows browsers the page, in which the stream can be "
            "touched; off: it answers browsers with one sentence. Default: on");
  addHttp(app, settings);
  addMulticast(app, settings.multicast);
  addNumber(app, "--multicast-ttl", settings.multicast_hops, std::uint64_t{1}, std::uint64_t{255},
            "N 1..255", "How many networks multicast may cross; default: 1, this one");
  addNumber(app, "--max-clients", settings.max_clients, std::uint64_t{1}, std::uint64_t{10'000},
            "N",
            "The largest number of viewers; the server rejects more with a message; default: 64");
  addTlsOptions(app, settings);
  const auto announce = [&settings](const std::string& text) {
    settings.announce = serviceName("--announce", text);
  };
  app.add_option_function<std::string>(
         "--announce", announce,
         "Announce this server on the LAN as NAME (mDNS), so that clients find it; default: no "
         "announcement")
      ->type_name("NAME");
}

void addNatsOptions(CLI::App& app, Settings& settings) {
  app.add_option("--nats-creds", settings.nats.creds_file,
                 "The file with the credentials for NATS (JWT and NKey seed)")
      ->type_name("FILE");
  app.add_option("--nats-ca", settings.nats.ca_file,
                 "Use TLS to NATS; the servers' certificates must be of an authority in this file")
      ->type_name("FILE");
  addOriginKey(app, settings.origin_keys);
}

void requireNetworkFlags(const Settings& settings) {
  const TlsFiles& tls = settings.tls;
  if (tls.certificate.empty() != tls.key.empty())
    throw CLI::ValidationError(tls.key.empty() ? "--tls-cert" : "--tls-key",
                               "--tls-cert and --tls-key belong together");
  if (tls.automatic && !tls.certificate.empty())
    throw CLI::ValidationError("--tls", "auto and --tls-cert exclude each other");
  if (settings.insecure && settings.tokens_file.empty())
    throw CLI::ValidationError("--insecure", "needs --tokens");
  if (!settings.host_names.empty() && !settings.http && !settings.page)
    throw CLI::ValidationError("--host-name", "needs the page (--page on) or --http");
}

}  // namespace hapticast::server
