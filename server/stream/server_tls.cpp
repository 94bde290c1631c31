// SPDX-License-Identifier: MIT
#include "server/stream/server_tls.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "common/private_file.hpp"
#include "server/stream/key_file.hpp"

namespace hapticast::server {

namespace {

std::string readOrThrow(const std::string& flag, const std::string& file) {
  auto text = readSmallFile(file);
  if (!text.ok()) throw KeyFileError(flag + " " + file + ": " + text.error().message);
  return std::move(text).value();
}

/// Returns the pair in the state folder. Makes it at the first call.
TlsIdentity loadOwnIdentity(const std::string& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error)) {
    std::string both = readOrThrow("--tls auto:", file);
    return {both, both};
  }
  TlsIdentity made = makeTlsIdentity();
  if (const auto failure = writePrivateFile(file, made.certificate_pem + made.key_pem))
    throw KeyFileError("--tls auto: " + file + ": " + failure->message +
                       "; set XDG_STATE_HOME to a folder of yours");
  spdlog::info("--tls auto: made a key pair and stored it in {}", file);
  return made;
}

}  // namespace

std::optional<TlsContext> loadServerTls(const TlsFiles& files, LimitedLog& log) {
  if (!files.wanted()) return std::nullopt;
  const std::string own = (stateFolder() / "tls.pem").string();
  const std::string key_file = files.automatic ? own : files.key;
  const TlsIdentity identity = files.automatic
                                   ? loadOwnIdentity(own)
                                   : TlsIdentity{readOrThrow("--tls-cert", files.certificate),
                                                 readOrThrow("--tls-key", files.key)};
  auto context = TlsContext::ofServer(identity);
  if (!context.ok()) {
    const std::string place = files.automatic
                                  ? "--tls auto: " + own
                                  : "--tls-cert " + files.certificate + ", --tls-key " + files.key;
    throw KeyFileError(place + ": " + context.error().message +
                       (files.automatic ? "; remove it, and the server makes another one" : ""));
  }
  if (auto warning = findReaders(files.automatic ? "--tls auto" : "--tls-key", key_file,
                                 "answer as this server"))
    log.warn(std::move(*warning));
  return std::move(context).value();
}

}  // namespace hapticast::server
