// SPDX-License-Identifier: MIT
// decode(): no bytes crash it, and what it accepts can be sent on: encoded again, it is accepted
// again.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "common/protocol/messages.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::wire {

HAPTICAST_FUZZ_TARGET("wire") {
  const auto message = hapticast::decode(std::span(data, size));
  if (!message.ok()) return 0;
  const auto bytes = hapticast::encode(message.value());
  const auto again = hapticast::decode(bytes);
  if (!again.ok()) std::abort();
  if (again.value().index() != message.value().index()) std::abort();
  return 0;
}

}  // namespace hapticast::fuzz::wire
