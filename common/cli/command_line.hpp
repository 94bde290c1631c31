// SPDX-License-Identifier: MIT
// What the command lines of both programs share: values that a flag and a config key read alike,
// and how a wrong one is told. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "common/text.hpp"

namespace hapticast {

inline constexpr std::uint16_t kDefaultPort = 7447;

struct Endpoint {
  std::string host;
  std::uint16_t port = kDefaultPort;
  bool operator==(const Endpoint&) const = default;
};

/// HOST, HOST:PORT, [V6ADDRESS] or [V6ADDRESS]:PORT; nullopt if it is none of them.
std::optional<Endpoint> parseEndpoint(const std::string& text);
/// Two finite numbers "A,B"; nullopt otherwise.
std::optional<Vec2> parsePair(const std::string& text);

/// Options bound to a value of these types; a wrong text is told with `form`, for example "U,V in
/// px".
CLI::Option* addEndpoint(CLI::App& app, const std::string& name, Endpoint& value,
                         const std::string& help);
CLI::Option* addPairs(CLI::App& app, const std::string& name, std::vector<Vec2>& values,
                      const std::string& help, const std::string& form);

/// The number that `text` is; CLI::ValidationError if it is none from `least` to `most`.
/// For double and std::uint64_t.
template <class Number>
Number numberOrThrow(const std::string& name, const std::string& text, Number least, Number most);

/// A finite number from `least` to `most`; `unit` is for the help. A Value takes a Number.
template <class Value, class Number>
CLI::Option* addNumber(CLI::App& app, const std::string& name, Value& value, Number least,
                       Number most, const std::string& unit, const std::string& help) {
  const auto set = [&value, name, least, most](const std::string& text) {
    value = numberOrThrow(name, text, least, most);
  };
  return app.add_option_function<std::string>(name, set, help)->type_name(unit);
}

/// One of the named `choices` (which have to outlive `app`).
template <class Value>
CLI::Option* addChoice(CLI::App& app, const std::string& name, Value& value,
                       const std::map<std::string, Value>& choices, const std::string& help) {
  std::string names;
  for (const auto& choice : choices) names += (names.empty() ? "" : "|") + choice.first;
  const auto set = [&value, &choices, name, names](const std::string& text) {
    const auto found = choices.find(text);
    if (found == choices.end())
      throw CLI::ValidationError(name, inQuotes(text) + " is not one of " + names);
    value = found->second;
  };
  return app.add_option_function<std::string>(name, set, help)->type_name(names);
}

/// Lets `--config FILE` hold every flag of `app` as a key of the same name (`key = value` lines,
/// readKeyValues(); a list is a key repeated); unknown keys are refused.
void addConfigFile(CLI::App& app);

/// `text` with control characters as '?': what files and peers bring must not steer a terminal.
std::string oneLine(std::string text);

/// Parses; nullopt: go on. Otherwise the exit code to leave with, after one line on stderr (2) or
/// the help (0).
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace hapticast
