// SPDX-License-Identifier: MIT
#include "client/servers/server_trust.hpp"

#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "client/servers/find_server.hpp"
#include "client/servers/known_origins.hpp"
#include "common/mdns.hpp"
#include "common/private_file.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::client {

namespace {

std::string readFileOf(const std::string& flag, const std::string& file) {
  auto text = readSmallFile(file);
  if (!text.ok()) throw std::runtime_error(flag + " " + file + ": " + text.error().message);
  return std::move(text).value();
}

/// Makes dial functions with TLS for one server.
class TlsTrust {
 public:
  TlsTrust(const ServerSettings& settings, std::string server)
      : ca_file_(settings.tls_ca_file), server_(std::move(server)) {
    if (ca_file_.empty()) return;
    auto context = TlsContext::ofClient(readFileOf("--tls-ca", ca_file_));
    if (!context.ok())
      throw std::runtime_error("--tls-ca " + ca_file_ + ": " + context.error().message);
    context_ = std::move(context).value();
  }

  /// `announced`: the fingerprint that the server announces, or nullopt.
  Dial dial(const std::optional<Fingerprint>& announced) {
    if (!ca_file_.empty()) return makeTlsDial(context_, nullptr);
    if (pin_ == nullptr)
      pin_ = std::make_shared<OriginPin>(makeTlsPin(server_, stateFolder() / "known_servers"));
    return makeTlsDial(context_,
                       [announced, pin = pin_,
                        server = server_](const Fingerprint& key) -> std::optional<std::string> {
                         if (announced && *announced != key)
                           return "the server at " + server +
                                  " shows another TLS key than it announces";
                         return pin->refuse(key);
                       });
  }

 private:
  std::string ca_file_;
  std::string server_;
  TlsContext context_ = TlsContext::ofPinningClient();
  std::shared_ptr<OriginPin> pin_;  // network thread, after the first dial
};

}  // namespace

bool parseServer(const std::string& text, ServerSettings& settings) {
  constexpr std::string_view kAnnounced = "mdns:";
  constexpr std::string_view kPlain = "hapticast://";
  constexpr std::string_view kTls = "hapticasts://";
  settings.server_given = true;
  settings.announced.clear();
  settings.tls = false;
  if (text.starts_with(kAnnounced)) {
    settings.announced = text.substr(kAnnounced.size());
    return isServiceName(settings.announced);
  }
  settings.tls = text.starts_with(kTls);
  const std::size_t scheme = settings.tls               ? kTls.size()
                             : text.starts_with(kPlain) ? kPlain.size()
                                                        : 0;
  const auto server = parseEndpoint(text.substr(scheme), ServerSettings{}.server);
  if (!server || server->port == 0) return false;
  settings.server = *server;
  return true;
}

std::string nameServer(const ServerSettings& settings) {
  if (!settings.announced.empty()) return "mdns:" + settings.announced;
  return (settings.tls ? "hapticasts://" : "") + toString(settings.server);
}

Dial chooseDial(const ServerSettings& settings, const std::string& server) {
  if (!settings.tls && settings.announced.empty()) {
    if (!settings.tls_ca_file.empty())
      throw std::runtime_error("--tls-ca: needs an address hapticasts://HOST");
    return dialTcp;
  }
  const auto trust = std::make_shared<TlsTrust>(settings, server);
  if (settings.announced.empty()) return trust->dial(std::nullopt);
  return dialAnnounced(settings.announced, [trust, server, ca = !settings.tls_ca_file.empty()](
                                               const FoundServer& found) {
    const auto announced = parseKey(found.tls);
    // A server that once had TLS must have it again.
    const bool needs_tls = ca || knowsTlsKey(server, stateFolder() / "known_servers");
    if (announced || needs_tls) return trust->dial(announced);
    return Dial(dialTcp);
  });
}

SessionSettings makeSessionSettings(const ServerSettings& settings, const std::string& server) {
  SessionSettings to;
  to.origin = makeOriginPin(settings.origin_keys, server, stateFolder() / "known_origins");
  to.access_token = loadToken(settings.token_file);
  to.insecure = settings.insecure;
  return to;
}

std::string loadToken(const std::string& file) {
  if (file.empty()) return "";
  constexpr const char* kSpace = " \t\r\n";
  std::string token = readFileOf("--token-file", file);
  token.erase(token.find_last_not_of(kSpace) + 1);
  token.erase(0, token.find_first_not_of(kSpace));
  if (token.empty() || token.size() > limits::kAccessToken)
    throw std::runtime_error("--token-file " + file + ": has no token of 1 to 256 bytes");
  return token;
}

}  // namespace hapticast::client
