// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>

namespace hapticast::server {

/// What was given as address is none, or none of this machine: wrong input, where other failures to
/// listen are the machine's. One line, which begins with the flag where that is not --listen.
class AddressError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hapticast::server
