// SPDX-License-Identifier: MIT
#include "server/source/stream_url.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>

#include "common/text.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::server {

namespace {

constexpr std::string_view kAfterScheme = "://";
constexpr std::array<std::string_view, 8> kSchemes{"rtsp",  "rtsps", "srt", "http",
                                                   "https", "udp",   "tcp", "rtp"};

}  // namespace

std::string findScheme(std::string_view url) {
  return toLower(url.substr(0, url.find(kAfterScheme)));
}

bool isAddress(std::string_view spec) {
  const std::size_t end = spec.find(kAfterScheme);
  return end != std::string_view::npos && end > 0 &&
         std::all_of(spec.begin(), spec.begin() + static_cast<std::ptrdiff_t>(end),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '-'; });
}

bool isStreamUrl(std::string_view spec) {
  return isAddress(spec) &&
         std::find(kSchemes.begin(), kSchemes.end(), findScheme(spec)) != kSchemes.end();
}

std::string hideCredentials(std::string_view spec) {
  if (!isAddress(spec)) {
    // An address that is written wrongly, for example with one slash.
    const std::size_t colon = spec.find(':');
    const bool is_wrong = colon != std::string_view::npos && spec.substr(colon).starts_with(":/") &&
                          spec.find('@', colon) != std::string_view::npos;
    return is_wrong ? findScheme(spec.substr(0, colon)) + ":..." : std::string(spec);
  }
  const std::string scheme = findScheme(spec) + std::string(kAfterScheme);
  std::string_view rest = spec.substr(scheme.size());
  // A password with a raw '/', '?' or '#' ends behind the place where the host should end.
  const std::size_t host_end = std::min(rest.find_first_of("/?#"), rest.size());
  if (rest.find('@', host_end) != std::string_view::npos) return scheme + "...";
  const std::size_t at = rest.substr(0, host_end).rfind('@');
  if (at != std::string_view::npos) rest.remove_prefix(at + 1);
  return scheme + std::string(rest.substr(0, rest.find_first_of("?#")));
}

std::string streamName(std::string_view url) {
  const std::string shown = hideCredentials(url);
  std::string_view rest = std::string_view(shown).substr(shown.find(kAfterScheme) + 3);
  while (rest.ends_with('/')) rest.remove_suffix(1);
  const std::size_t slash = rest.rfind('/');
  const std::string_view last = slash == std::string_view::npos ? rest : rest.substr(slash + 1);
  return sanitizeUtf8(last.empty() ? findScheme(url) : last, limits::kStreamName);
}

}  // namespace hapticast::server
