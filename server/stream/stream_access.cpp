// SPDX-License-Identifier: MIT
#include "server/stream/stream_access.hpp"

#include <chrono>

namespace hapticast::server {

std::optional<WireError> StreamAccess::refuse(const std::string& token,
                                              const Channel& channel) const {
  if (!list_) return std::nullopt;
  if (!channel.encrypted() && !channel.ofThisMachine() && !insecure_)
    return WireError{ErrorCode::kUnauthorized,
                     std::string("this server needs TLS: ") +
                         (channel.carrier() == Carrier::kWebSocket ? "open its page by https"
                                                                   : "use hapticasts://HOST")};
  if (token.empty())
    return WireError{ErrorCode::kUnauthorized, "this server needs an access token (--token-file)"};
  const auto grant = list_->find(token);
  if (!grant) return WireError{ErrorCode::kUnauthorized, "the access token is unknown"};
  if (grant->expired(std::chrono::system_clock::now()))
    return WireError{ErrorCode::kUnauthorized, "the access token has expired"};
  return std::nullopt;
}

bool StreamAccess::permits(const std::optional<Grant>& grant) const {
  if (!list_) return true;
  return grant && list_->permits(*grant, std::chrono::system_clock::now());
}

}  // namespace hapticast::server
