// SPDX-License-Identifier: MIT
// SHA-512 (FIPS 180-4, section 6.4), for signatures in a web page. Thread: any.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace hapticast::client {

/// Returns the SHA-512 of the parts in their order.
[[nodiscard]] std::array<std::uint8_t, 64> computeSha512(
    std::span<const std::span<const std::uint8_t>> parts);

}  // namespace hapticast::client
