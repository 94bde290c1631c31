// SPDX-License-Identifier: MIT
// AccessList::parse(): any text is read or refused with an error that begins with a line's number.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/stream/access_list.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::tokens {

HAPTICAST_FUZZ_TARGET("tokens") {
  using namespace hapticast::server;
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  const auto list = AccessList::parse(text);
  if (list.ok()) {
    if (list.value().size() > AccessList::kMostGrants) std::abort();
    const auto grant = list.value().find(text);
    if (grant && !grant->last_day && !list.value().permits(*grant, {})) std::abort();
  } else if (list.error().message.empty() || list.error().message[0] < '1' ||
             list.error().message[0] > '9') {
    std::abort();
  }
  return 0;
}

}  // namespace hapticast::fuzz::tokens
