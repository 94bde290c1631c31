// SPDX-License-Identifier: MIT
#include "client/settings/server_options.hpp"

#include <map>
#include <string>

#include "client/settings/command_line.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/text.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::client {

namespace {

const std::map<std::string, Transport> kTransports{
    {transportName(Transport::kDatagrams), Transport::kDatagrams},
    {transportName(Transport::kTcp), Transport::kTcp},
    {transportName(Transport::kGroup), Transport::kGroup}};

/// Adds the flags of trust between client and server.
void addTrust(CLI::App& app, Settings& settings) {
  app.add_option("--tls-ca", settings.tls_ca_file,
                 "With hapticasts://: accept only servers whose certificate is of an authority in "
                 "this file (PEM). Default: the key of the first connection, which the client "
                 "stores in hapticast/known_servers in $XDG_STATE_HOME, else in ~/.local/state")
      ->type_name("FILE");
  app.add_option("--token-file", settings.token_file,
                 "The file with the access token for the server")
      ->type_name("FILE");
  app.add_flag("--insecure", settings.insecure,
               "Send the access token to other machines without TLS, too");
}

void addServerAddress(CLI::App& app, Settings& settings) {
  const auto set = [&settings](const std::string& text) { setServer(settings, text); };
  app.add_option_function<std::string>(
         "server", set,
         "The address of hapticast-server, or mdns:NAME for the server announced as NAME. Default: "
         "localhost:7447; while no server answers there, the log lists the servers on the LAN. The "
         "client waits until the server answers")
      ->type_name(kServerForm);
  addList(app, "--origin-key", settings.origin_keys, parseOriginKey,
          "The public key of the server, in hex; the client ends if the server shows another one. "
          "May appear more than once. The word first: the key of the first connection, which the "
          "client stores in hapticast/known_origins in $XDG_STATE_HOME, else in ~/.local/state. "
          "Default: any key",
          "KEY|first (64 hex digits of the server's public key, or first)");
}

}  // namespace

void setServer(Settings& settings, const std::string& text) {
  if (parseServer(text, settings)) {
    if (!settings.announced.empty()) requireDiscovery("server");
    return;
  }
  if (text.starts_with("mdns:")) (void)serviceName("server", settings.announced);
  throw CLI::ValidationError("server", quote(text) +
                                           " is not HOST[:PORT], PORT, [V6ADDRESS]:PORT, "
                                           "hapticasts://HOST or mdns:NAME (port 1..65535)");
}

void addServerOptions(CLI::App& app, Settings& settings) {
  addServerAddress(app, settings);
  addTrust(app, settings);
}

void addDeliveryOptions(CLI::App& app, Settings& settings) {
  DeliverySettings& delivery = settings.delivery;
  addChoice(app, "--transport", delivery.best, kTransports,
            "The transport of the frames: udp (default), tcp, or multicast if the server sends to "
            "a group. If a transport fails, the client falls back from multicast to udp and from "
            "udp to tcp, and tries again every 30 s");
  const auto set = [&delivery](const std::string& text) {
    const auto copies = parseNumberInRange<std::uint64_t>(text, 1, limits::kMostCopies);
    if (text != "auto" && !copies)
      throw CLI::ValidationError("--redundancy", quote(text) + " is not auto or 1..4");
    delivery.copies = static_cast<std::uint32_t>(copies.value_or(0));
  };
  app.add_option_function<std::string>("--redundancy", set,
                                       "The number of sends of each datagram, one frame apart: "
                                       "auto (default; follows the network's loss), or 1..4")
      ->type_name("auto|N")
      ->default_str("auto");
  app.add_option("--interface", delivery.interface_name,
                 "The network interface that joins a multicast group, by name or address; default: "
                 "the interface of the route to the server")
      ->type_name("NAME|ADDRESS");
  addNumber(app, "--max-delay", settings.max_delay_ms, 20.0, 2000.0, "MS",
            "The largest playout delay; default: 2000. The client adapts the delay to the network. "
            "A stream that needs more counts as interrupted: the force fades");
}

}  // namespace hapticast::client
