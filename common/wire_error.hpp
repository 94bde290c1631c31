// SPDX-License-Identifier: MIT
// Errors between two peers, with the codes of the protocol. Thread: any.
#pragma once

#include <cstdint>
#include <string>

namespace hapticast {

/// Codes of the wire protocol (proto/README.md).
enum class ErrorCode : std::uint8_t {
  kMalformed = 1,     ///< the message cannot be decoded, or a value is outside its range
  kTooLarge = 2,      ///< a length or a count exceeds the protocol's limit
  kVersion = 3,       ///< the peer uses another version of the protocol
  kUnexpected = 4,    ///< a valid message at the wrong time
  kServerFull = 5,    ///< the server accepts no more clients
  kTimeout = 6,       ///< the peer was silent for too long
  kShuttingDown = 7,  ///< the server shuts down
  kUnauthorized = 8,  ///< the client's token is missing, unknown or expired, or it must use TLS
  kForbidden = 9,     ///< the client's token does not allow this request
};

/// An error to send to a peer.
struct WireError {
  ErrorCode code;
  std::string message;  ///< one sentence
};

inline WireError malformed(const char* what) { return {ErrorCode::kMalformed, what}; }

}  // namespace hapticast
