// SPDX-License-Identifier: MIT
// A small reader of JSON from outside: the scalars of an object by dotted path. (OpenCV's own
// reader refuses null and \u escapes, which other programs write.) Thread: any.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace hapticast::server {

/// Path ("intrinsics.fx") -> text of the value: a string without quotes (escapes of one character
/// resolved, \u kept as '?'), or a number, true, false, null as written. Elements of arrays are
/// left out. nullopt: not a JSON object, nested deeper than 32, or a path longer than 256 bytes.
[[nodiscard]] std::optional<std::map<std::string, std::string>> readJsonScalars(
    std::string_view text);

}  // namespace hapticast::server
