// SPDX-License-Identifier: MIT
#include "client/servers/known_origins.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/private_file.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

struct KnownOrigin {
  std::string server;
  KeyBytes key;
  int line = 0;
};

/// Begins messages about the file of these keys.
std::string nameKind(PinKind kind) {
  return kind == PinKind::kTls ? "TLS keys of servers: " : "--origin-key first: ";
}

/// Returns the text of the file; empty if there is no file. Throws std::runtime_error.
std::string readText(PinKind kind, const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error) && !error) return {};
  auto text = readSmallFile(file);
  if (text.ok()) return std::move(text).value();
  throw std::runtime_error(nameKind(kind) + file.string() + ": " + text.error().message +
                           "; correct or remove it");
}

/// Returns the lines of the file's text. Throws std::runtime_error at a malformed line.
std::vector<KnownOrigin> parseOrigins(PinKind kind, const std::filesystem::path& file,
                                      const std::string& text) {
  std::vector<KnownOrigin> known;
  std::istringstream in(text);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (trim(line).empty()) continue;
    const std::size_t space = line.rfind(' ');
    const auto key = space == std::string::npos || space == 0
                         ? std::nullopt
                         : parseKey(std::string_view(line).substr(space + 1));
    if (!key) {
      throw std::runtime_error(nameKind(kind) + file.string() + ":" + std::to_string(number) +
                               ": " + quote(line) +
                               " is not HOST:PORT and a key of 64 hex digits; correct or delete "
                               "the line");
    }
    known.push_back({line.substr(0, space), *key, number});
  }
  return known;
}

std::string nameRemedy(const std::filesystem::path& file, int line) {
  return "; to accept its new key, delete line " + std::to_string(line) + " of " + file.string();
}

/// Adds a line to the file. Returns the remedy for a later refusal.
Result<std::string> storeOrigin(PinKind kind, const std::filesystem::path& file,
                                const std::string& server, const KeyBytes& key) {
  try {
    std::string text = readText(kind, file);  // another client may have added a line
    (void)parseOrigins(kind, file, text);
    if (!text.empty() && text.back() != '\n') text += '\n';
    const auto lines = std::count(text.begin(), text.end(), '\n');
    text += server + " " + toHex(key) + "\n";
    if (const auto error = writePrivateFile(file, text)) {
      return Error{nameKind(kind) + file.string() + ": " + error->message +
                   "; make its folder writable, or name the key itself"};
    }
    spdlog::info("the client expects the key {} of {} from now on, and stores it in {}", toHex(key),
                 server, file.string());
    return nameRemedy(file, static_cast<int>(lines) + 1);
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
}

/// Returns the pin that accepts `expected`, and the key that the server shows first.
OriginPin pinFirst(PinKind kind, std::vector<KeyBytes> expected, const std::string& server,
                   const std::filesystem::path& file) {
  for (const KnownOrigin& each : parseOrigins(kind, file, readText(kind, file))) {
    if (each.server != server) continue;
    expected.push_back(each.key);
    return {server, std::move(expected), nullptr, nameRemedy(file, each.line), kind};
  }
  return {
      server, std::move(expected),
      [kind, file, server](const KeyBytes& key) { return storeOrigin(kind, file, server, key); },
      "", kind};
}

}  // namespace

OriginPin makeOriginPin(const std::vector<OriginKey>& keys, const std::string& server,
                        const std::filesystem::path& file) {
  if (keys.empty()) return {};
  std::vector<KeyBytes> expected;
  bool first = false;
  for (const OriginKey& each : keys) {
    if (each.key) expected.push_back(*each.key);
    first = first || !each.key;
  }
  if (!first) return {server, std::move(expected)};
  return pinFirst(PinKind::kOrigin, std::move(expected), server, file);
}

bool knowsTlsKey(const std::string& server, const std::filesystem::path& file) {
  const auto known = parseOrigins(PinKind::kTls, file, readText(PinKind::kTls, file));
  return std::any_of(known.begin(), known.end(),
                     [&server](const KnownOrigin& each) { return each.server == server; });
}

OriginPin makeTlsPin(const std::string& server, const std::filesystem::path& file) {
  return pinFirst(PinKind::kTls, {}, server, file);
}

}  // namespace hapticast::client
