// SPDX-License-Identifier: MIT
// Messages of the server for users of the library: names of members replace the flags of the
// command line. Thread: any.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace hapticast {

/// Returns `message` with the names of members in place of flags.
[[nodiscard]] inline std::string nameMembers(std::string message) {
  using Replacement = std::pair<std::string_view, std::string_view>;
  static constexpr std::array<Replacement, 11> kReplacements{{
      {" with --listen", ""},
      {"--listen", "listen"},
      {"--max-clients", "max_viewers"},
      {"--tls-cert", "tls_cert_file"},
      {"--tls-key", "tls_key_file"},
      {"--tokens", "tokens_file"},
      {"--source ", "source "},
      {"--object", "objects"},
      {"--not ", "not_objects "},
      {"--map-range", "map_range"},
      {"--fov", "fov_deg"},
  }};
  for (const auto& [flag, member] : kReplacements) {
    for (auto at = message.find(flag); at != std::string::npos; at = message.find(flag, at))
      message.replace(at, flag.size(), member);
  }
  return message;
}

}  // namespace hapticast
