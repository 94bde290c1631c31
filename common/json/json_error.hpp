// SPDX-License-Identifier: MIT
// A mistake in a JSON text, with its place. Thread: any.
#pragma once

#include <stdexcept>
#include <string>

namespace hapticast {

/// Place in a text, from 1. A column counts bytes.
struct JsonPlace {
  int line = 1;
  int column = 1;
  bool operator==(const JsonPlace&) const = default;
};

/// The text is no valid JSON, or a member is wrong. The message does not name the file.
struct JsonError : std::runtime_error {
  JsonError(JsonPlace at, const std::string& what) : std::runtime_error(what), place(at) {}
  JsonPlace place;
};

/// Returns "NAME:LINE:COLUMN: MESSAGE" for the file `name`.
[[nodiscard]] std::string describe(const std::string& name, const JsonError& error);

}  // namespace hapticast
