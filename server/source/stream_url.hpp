// SPDX-License-Identifier: MIT
// Addresses of live streams (rtsp://, srt://, http:// and others), and their texts without secrets.
// Thread: any.
#pragma once

#include <string>
#include <string_view>

namespace hapticast::server {

/// Schemes that isStreamUrl() accepts, for messages.
inline constexpr const char* kStreamSchemes =
    "rtsp://, rtsps://, srt://, http://, https://, udp://, tcp:// or rtp://";

/// Returns whether `spec` begins with a scheme and "://".
[[nodiscard]] bool isAddress(std::string_view spec);
/// Returns whether `spec` begins as an address whose scheme is one of kStreamSchemes. Capital
/// letters of the scheme count as small ones.
[[nodiscard]] bool isStreamUrl(std::string_view spec);
/// Returns the scheme of an address in small letters, for example "rtsp".
[[nodiscard]] std::string findScheme(std::string_view url);
/// Returns `spec` without secrets if it is an address: without user, password, query and fragment.
/// If the end of the password is ambiguous, it also removes the whole host and path. Other texts
/// are unchanged.
[[nodiscard]] std::string hideCredentials(std::string_view spec);
/// Returns the name of a stream for viewers, without secrets: the last part of the path, else the
/// host.
[[nodiscard]] std::string streamName(std::string_view url);

}  // namespace hapticast::server
