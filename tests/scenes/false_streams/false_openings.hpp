// SPDX-License-Identifier: MIT
// False beginnings of a session as data: each row has the messages that a server sends after the
// hello, and a part of the sentence with which each client has to end the session.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hapticast::testing {

struct FalseOpening {
  std::string name;
  std::vector<std::vector<std::uint8_t>> messages;  ///< payloads
  std::string why;
  /// It is false over a connection without TLS only.
  bool is_plain_only = false;
};

/// Returns all of them.
std::vector<FalseOpening> listFalseOpenings();

}  // namespace hapticast::testing
