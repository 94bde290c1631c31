// SPDX-License-Identifier: MIT
// Flags that only one of the two programs has, for hints in error messages. Tests compare the lists
// with the parsers of both programs. Thread: any.
#pragma once

#include <span>
#include <string_view>

namespace hapticast {

inline constexpr std::string_view kServerProgram = "hapticast-server";
inline constexpr std::string_view kClientProgram = "hapticast-client";

/// Returns the names, without "--", of the flags that `program` has and the other program lacks.
/// `program`: kServerProgram or kClientProgram. The list includes the flags of optional parts that
/// this build lacks.
[[nodiscard]] std::span<const std::string_view> ownFlags(std::string_view program);

/// Returns the name of the other program if that program has the flag `flag` and `program` lacks
/// it. Otherwise returns an empty text. `flag` may begin with "--" and may end with "=VALUE".
[[nodiscard]] std::string_view ownerOfFlag(std::string_view flag, std::string_view program);

}  // namespace hapticast
