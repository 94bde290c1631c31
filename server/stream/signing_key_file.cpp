// SPDX-License-Identifier: MIT
#include "server/stream/signing_key_file.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "common/private_file.hpp"
#include "server/stream/key_file.hpp"

namespace hapticast::server {

namespace {

namespace fs = std::filesystem;

KeyFileError keyError(const std::string& file, const std::string& what) {
  return KeyFileError("--signing-key " + file + ": " + what);
}

SigningKey createSigningKey(const std::string& file) {
  SigningKey key;
  if (const auto error = writePrivateFile(file, key.toPem()))
    throw keyError(file, error->message + "; name a file in a folder of yours");
  spdlog::info("--signing-key {}: created with a new key", file);
  return key;
}

}  // namespace

SigningKey loadSigningKey(const std::string& file) {
  std::error_code error;
  if (fs::status(file, error).type() == fs::file_type::not_found) return createSigningKey(file);
  const auto pem = readSmallFile(file);
  if (!pem.ok()) throw keyError(file, pem.error().message + "; name a file that you may read");
  auto key = SigningKey::fromPem(pem.value());
  if (!key.ok()) {
    throw keyError(file, key.error().message +
                             "; name a file that does not exist, and the server creates a key");
  }
  if (const auto warning = findReaders("--signing-key", file, "sign as this server"))
    spdlog::warn("{}", *warning);
  return std::move(key).value();
}

}  // namespace hapticast::server
