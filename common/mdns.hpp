// SPDX-License-Identifier: MIT
// How servers are announced on a LAN (DNS-SD over mDNS, RFC 6763): type, record, names. What comes
// from there is a stranger's text. Thread: any, not the loop's (allocates).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hapticast {

inline constexpr const char* kServiceType = "_hapticast._tcp";
/// Keys of its TXT record: the protocol's version as a number, and the stream's name for people.
inline constexpr const char* kServiceVersionKey = "version";
inline constexpr const char* kTxtTitleKey = "plays";
inline constexpr std::size_t kMaxServiceName_bytes = 63;    ///< RFC 6763, section 4.1.1
inline constexpr std::size_t kMaxServicePlays_bytes = 100;  ///< chosen; what one line has room for

/// `text` as it may be shown: of valid UTF-8, with '?' for bytes that are none, for control
/// characters (C0, C1) and for those that reorder or hide text; cut to `most_bytes` between two
/// characters.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most_bytes);

/// Whether a server can be announced by this name: 1 to 63 bytes that printable() leaves alone.
[[nodiscard]] bool isServiceName(std::string_view text);

}  // namespace hapticast
