// SPDX-License-Identifier: MIT
// The page's reader of messages (client/web/messages) against libprotobuf: both accept the same
// bytes, read the same content, and refuse the others with the same sentence.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/messages.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast_page {
std::optional<std::vector<std::uint8_t>> recode(std::span<const std::uint8_t> bytes,
                                                std::string& error);
}  // namespace hapticast_page

namespace hapticast::fuzz::messages {

HAPTICAST_FUZZ_TARGET("messages") {
  const std::span bytes(data, size);
  const auto expected = hapticast::decode(bytes);
  std::string error;
  const auto found = hapticast_page::recode(bytes, error);
  const bool same = expected.ok() ? found && *found == hapticast::encode(expected.value())
                                  : !found && error == expected.error().message;
  if (same) return 0;
  std::fprintf(stderr, "libprotobuf: %s, page: %s\n",
               expected.ok() ? "a message" : expected.error().message.c_str(),
               found ? "a message" : error.c_str());
  std::abort();
}

}  // namespace hapticast::fuzz::messages
