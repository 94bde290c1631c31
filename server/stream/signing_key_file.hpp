// SPDX-License-Identifier: MIT
// File of the key with which the server signs (--signing-key): a private key of Ed25519 in PEM
// (PKCS#8). With it the server shows the same public key in each run. Thread: main, at start-up.
#pragma once

#include <stdexcept>
#include <string>

#include "common/transport/signature.hpp"

namespace hapticast::server {

/// Reports a key file that cannot be used. It is an error of the user. The message is one line,
/// begins with the flag and has the remedy.
class SigningKeyError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns the key in `file`. If there is no such file, creates it with a random key; only its
/// owner may read it. Logs a warning if other users may read the file. Throws SigningKeyError.
[[nodiscard]] SigningKey loadSigningKey(const std::string& file);

}  // namespace hapticast::server
