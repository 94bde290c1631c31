// SPDX-License-Identifier: MIT
// Decodes and encodes a message by the code of the page. The build renames the namespace, so that
// both versions are in one program.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/messages.hpp"

namespace hapticast {

std::optional<std::vector<std::uint8_t>> recode(std::span<const std::uint8_t> bytes,
                                                std::string& error) {
  const auto message = decode(bytes);
  if (message.ok()) return encode(message.value());
  error = message.error().message;
  return std::nullopt;
}

}  // namespace hapticast
