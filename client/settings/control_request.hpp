// SPDX-License-Identifier: MIT
// Parser for the text of an operator's request (--control). Thread: main, at start-up.
#pragma once

#include <optional>
#include <string>

#include "common/protocol/messages.hpp"

namespace hapticast::client {

/// Returns the request in `text`. It is a list, separated by commas, of `pause`, `play`,
/// `seek=SECONDS`, `speed=FACTOR`, and `NAME=VALUE` for a property of the material: stiffness,
/// damping, texture-depth, mass, or friction=STATIC:DYNAMIC. Returns nullopt for other texts.
[[nodiscard]] std::optional<Control> parseControl(const std::string& text);

}  // namespace hapticast::client
