// SPDX-License-Identifier: MIT
// How servers are announced on a LAN (DNS-SD over mDNS, RFC 6763): type, record, names. What comes
// from there is a stranger's text. Thread: any, not the loop's (allocates).
#pragma once

#include <cstddef>
#include <string_view>

#include "common/text.hpp"

namespace hapticast {

inline constexpr const char* kServiceType = "_hapticast._tcp";
/// Keys of its TXT record: the protocol's version as a number, and the stream's name for people.
inline constexpr const char* kServiceVersionKey = "version";
inline constexpr const char* kTxtTitleKey = "plays";
inline constexpr std::size_t kMaxServiceName_bytes = 63;    ///< RFC 6763, section 4.1.1
inline constexpr std::size_t kMaxServicePlays_bytes = 100;  ///< chosen; what one line has room for

/// Returns whether a server can be announced as `text`: 1 to 63 bytes that sanitizeUtf8() keeps.
[[nodiscard]] inline bool isServiceName(std::string_view text) {
  return !text.empty() && sanitizeUtf8(text, kMaxServiceName_bytes) == text;
}

}  // namespace hapticast
