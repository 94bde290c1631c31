// SPDX-License-Identifier: MIT
// Error of a listen or multicast address from the command line. Thread: any.
#pragma once

#include <stdexcept>

namespace hapticast::server {

/// An address that is invalid or does not belong to this machine: a user error, unlike other
/// failures to listen. The message is one line. It begins with the flag, except for --listen.
class AddressError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hapticast::server
