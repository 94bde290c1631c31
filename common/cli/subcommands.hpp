// SPDX-License-Identifier: MIT
// Subcommands, and command lines that name none. The first argument of a program is the name of its
// subcommand; only flags of the program, such as --quiet, may be before it. Without a name, a flag
// can choose the subcommand: `--replay FILE` stands for `replay --replay FILE`. A key of the config
// file chooses it in the same way. Otherwise a default subcommand is meant.
// Thread: main, at start-up.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/cli/cli11.hpp"

namespace hapticast {

/// A flag that chooses a subcommand.
struct SubcommandFlag {
  std::string_view flag;        ///< with "--"; without "--" it is the key of a config file
  std::string_view subcommand;  ///< the subcommand has this flag, too
  /// Of the flag's value, which may also be the first argument; empty: any value.
  std::string_view prefix = {};
};

/// How a command line without the name of a subcommand gets one.
struct SubcommandChoice {
  std::string_view otherwise = {};  ///< default subcommand; empty: the program has no subcommands
  std::span<const SubcommandFlag> flags = {};
};

/// Adds a subcommand to `program`. The flags of the program are flags of the subcommand, too.
CLI::App& addSubcommand(CLI::App& program, const std::string& name, const std::string& description);

/// Returns `arguments` with the name of a subcommand of `app` in front. If a flag has chosen it,
/// this flag follows the name. Returns `arguments` unchanged if they ask for the help of the
/// program, or if they begin with a subcommand.
[[nodiscard]] std::vector<std::string> chooseSubcommand(const CLI::App& app,
                                                        const SubcommandChoice& choice,
                                                        std::vector<std::string> arguments);

/// Returns the subcommand of `app` that `name` names; `app` itself if there is none.
[[nodiscard]] const CLI::App& findSubcommand(const CLI::App& app, std::string_view name);

/// Returns the name of a subcommand of `app`, other than `than`, that has the option `name`, for
/// example "--replay"; empty if there is none.
[[nodiscard]] std::string findOwner(const CLI::App& app, const std::string& name,
                                    const CLI::App& than);

}  // namespace hapticast
