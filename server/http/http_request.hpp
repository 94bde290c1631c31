// SPDX-License-Identifier: MIT
// Reads the requests of one HTTP connection from its bytes, which can arrive in any portions. It
// has no sockets and no clocks. Only its source file includes Boost.Beast. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/result.hpp"

namespace hapticast::server {

/// Status codes that this server sends (RFC 9110, RFC 6585).
enum class HttpStatus : std::uint16_t {
  kOk = 200,
  kMalformed = 400,
  kNotFound = 404,
  kMethodNotAllowed = 405,
  kContentTooLarge = 413,
  kHeadersTooLarge = 431,
  kUnavailable = 503,
};

/// Methods that this server distinguishes.
enum class HttpMethod : std::uint8_t { kGet, kHead, kOther };

/// One request, without its header fields.
struct HttpRequest {
  HttpMethod method = HttpMethod::kOther;
  std::string path;         ///< target without its query
  bool has_body = false;    ///< a body follows; the server reads none
  bool keep_alive = false;  ///< whether the client wants to send another request
};

/// Splits the bytes of one connection into requests.
class HttpRequestReader {
 public:
  /// Largest size of a request line with its header fields.
  static constexpr std::size_t kMaxHead_bytes = 8192;

  /// Adds bytes that have arrived.
  void feed(std::span<const std::uint8_t> bytes) { bytes_.append(bytes.begin(), bytes.end()); }
  /// Returns whether no byte waits.
  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  /// Removes the next request and returns it; nullopt if it has not arrived completely. Returns
  /// kMalformed or kHeadersTooLarge if the bytes are no request that this server reads. Close the
  /// connection then, and after a request with a body.
  Result<std::optional<HttpRequest>, HttpStatus> next();

 private:
  std::string bytes_;
};

}  // namespace hapticast::server
