// SPDX-License-Identifier: MIT
// Text of an operator's request (--control). Thread: main, at start-up.
#pragma once

#include <optional>
#include <string>

#include "common/protocol/messages.hpp"

namespace hapticast::client {

/// Returns the request in `text`: `pause`, `play`, `seek=SECONDS`, or `NAME=VALUE` of a material
/// (stiffness, damping, texture-depth, mass, friction=STATIC:DYNAMIC). Several are joined by
/// commas. Returns nullopt for other texts.
[[nodiscard]] std::optional<Control> parseControl(const std::string& text);

}  // namespace hapticast::client
