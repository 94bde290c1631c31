// SPDX-License-Identifier: MIT
// Announcement of a server on the LAN (DNS-SD over mDNS, RFC 6763): its service type, its TXT
// record and its name. Any host can send such texts, so they must be checked. Thread: any, but not
// the haptic loop (allocates).
#pragma once

#include <cstddef>
#include <string_view>

#include "common/text.hpp"

namespace hapticast {

inline constexpr const char* kServiceType = "_hapticast._tcp";
/// The page for browsers, as a web site, and its TXT record.
inline constexpr const char* kWebServiceType = "_http._tcp";
inline constexpr const char* kTlsWebServiceType = "_https._tcp";
inline constexpr const char* kWebServicePath = "path=/";
/// Keys of the TXT record. The value of kServiceVersionKey is the version of the protocol, as a
/// number. The value of kTxtTitleKey is the stream's name.
inline constexpr const char* kServiceVersionKey = "version";
inline constexpr const char* kTxtTitleKey = "plays";
/// Fingerprint of the server's TLS certificate, in hex; absent: the server has no TLS.
inline constexpr const char* kTxtTlsKey = "tls";
inline constexpr std::size_t kMaxServiceName_bytes = 63;    ///< RFC 6763, section 4.1.1
inline constexpr std::size_t kMaxServicePlays_bytes = 100;  ///< a choice: the text fits one line

/// Returns true if `text` is a valid service name: 1 to 63 bytes, without characters that
/// sanitizeUtf8() replaces.
[[nodiscard]] inline bool isServiceName(std::string_view text) {
  return !text.empty() && sanitizeUtf8(text, kMaxServiceName_bytes) == text;
}

}  // namespace hapticast
