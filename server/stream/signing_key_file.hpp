// SPDX-License-Identifier: MIT
// File of the key with which the server signs (--signing-key): a private key of Ed25519 in PEM
// (PKCS#8). So the server has the same public key in each run. Thread: main, at start-up.
#pragma once

#include <string>

#include "common/transport/signature.hpp"

namespace hapticast::server {

/// Returns the key in `file`. If there is no such file, creates it with a random key; only its
/// owner may read it. Logs a warning if other users may read the file. Throws KeyFileError.
[[nodiscard]] SigningKey loadSigningKey(const std::string& file);

}  // namespace hapticast::server
