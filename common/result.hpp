// SPDX-License-Identifier: MIT
// Bytes from outside never throw: what reads them returns a value or a typed error.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace hapticast {

/// What can be wrong with bytes from outside. The numbers go over the wire (proto/README.md).
enum class ErrorCode : std::uint8_t {
  kMalformed = 1,     ///< not decodable, or a field outside its valid range
  kTooLarge = 2,      ///< a length or count above the protocol's limit
  kVersion = 3,       ///< the peer speaks another protocol version
  kUnexpected = 4,    ///< a well-formed message at the wrong moment
  kServerFull = 5,    ///< no more clients are accepted
  kTimeout = 6,       ///< the peer said nothing for too long
  kShuttingDown = 7,  ///< the server ends
};

struct Error {
  ErrorCode code;
  std::string message;  ///< one sentence for people
};

/// A value or an Error. Requires ok() before value(), !ok() before error().
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return content_.index() == 0; }
  [[nodiscard]] T& value() & { return std::get<0>(content_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(content_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(content_)); }
  [[nodiscard]] const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

}  // namespace hapticast
