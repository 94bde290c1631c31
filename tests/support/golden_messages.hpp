// SPDX-License-Identifier: MIT
// One fixed message of every kind, for the golden bytes of the wire and the seeds of the fuzzers.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::testing {

/// Name (also of its file in unit/common/golden) and message.
std::vector<std::pair<std::string, Message>> goldenMessages();

/// A frame with two objects that uses every field: heights on exact 16-bit steps, a grid, impacts.
HapticFrame goldenFrame();

StreamDescription goldenDescription();
/// One that offers datagrams and a group.
Welcome goldenWelcome();
DatagramKey goldenKey();
/// The key of the signed examples. Its seed is the bytes 00 01 02 .. 1f.
SigningKey goldenSigningKey();

}  // namespace hapticast::testing
