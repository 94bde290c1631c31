// SPDX-License-Identifier: MIT
// JSON text with the line of each member, for errors that name a place. The parser's callbacks see
// each key, and an iterator counts the lines that the parser has read.
// Thread: one.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hapticast::client {

/// The text is no valid JSON, or a member is wrong. The message does not name the file.
struct LocatedError : std::runtime_error {
  LocatedError(int line_number, const std::string& what)
      : std::runtime_error(what), line(line_number) {}
  int line;  ///< from 1
};

/// Lines by JSON pointer such as "/conditions/0/name".
using JsonLines = std::map<std::string, int>;

/// Parses an object with at most 8 levels, and stores the line of each member and of each object in
/// a list in `lines`. Throws LocatedError; also for a key that appears twice.
[[nodiscard]] nlohmann::json parseLocated(std::string_view text, JsonLines& lines);

}  // namespace hapticast::client
