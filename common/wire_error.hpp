// SPDX-License-Identifier: MIT
// What can be wrong between two peers, as both of them name it.
#pragma once

#include <cstdint>
#include <string>

namespace hapticast {

/// The numbers go over the wire (proto/README.md).
enum class ErrorCode : std::uint8_t {
  kMalformed = 1,     ///< not decodable, or a field outside its valid range
  kTooLarge = 2,      ///< a length or count above the protocol's limit
  kVersion = 3,       ///< the peer speaks another protocol version
  kUnexpected = 4,    ///< a well-formed message at the wrong moment
  kServerFull = 5,    ///< no more clients are accepted
  kTimeout = 6,       ///< the peer said nothing for too long
  kShuttingDown = 7,  ///< the server ends
};

struct WireError {
  ErrorCode code;
  std::string message;  ///< one sentence for people
};

inline WireError malformed(const char* what) { return {ErrorCode::kMalformed, what}; }

}  // namespace hapticast
