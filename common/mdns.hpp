// SPDX-License-Identifier: MIT
// Service announcement on a LAN (DNS-SD over mDNS, RFC 6763): type, record and names. Texts from
// the LAN are untrusted. Thread: any, but not the haptic loop (allocates).
#pragma once

#include <cstddef>
#include <string_view>

#include "common/text.hpp"

namespace hapticast {

inline constexpr const char* kServiceType = "_hapticast._tcp";
/// Keys of the TXT record: the protocol's version as a number, and the stream's name.
inline constexpr const char* kServiceVersionKey = "version";
inline constexpr const char* kTxtTitleKey = "plays";
inline constexpr std::size_t kMaxServiceName_bytes = 63;    ///< RFC 6763, section 4.1.1
inline constexpr std::size_t kMaxServicePlays_bytes = 100;  ///< chosen; fits one line

/// Returns whether `text` is a valid service name: 1 to 63 bytes that sanitizeUtf8() keeps.
[[nodiscard]] inline bool isServiceName(std::string_view text) {
  return !text.empty() && sanitizeUtf8(text, kMaxServiceName_bytes) == text;
}

}  // namespace hapticast
