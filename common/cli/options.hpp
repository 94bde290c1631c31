// SPDX-License-Identifier: MIT
// Options of the command line: values that a flag and a config key read alike, and how a wrong one
// is told. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/endpoint.hpp"
#include "common/geometry.hpp"
#include "common/spelling.hpp"
#include "common/text.hpp"

namespace hapticast {

/// Two finite numbers "A,B"; nullopt otherwise.
std::optional<Vec2> parsePair(const std::string& text);

/// The endpoint that `text` names, as parseEndpoint() has it; throws CLI::ValidationError, which
/// names the flag `name` and the `form`, where it is none or its port is below `least_port`.
[[nodiscard]] Endpoint parseEndpointOr(const std::string& text, const Endpoint& otherwise,
                                       const std::string& name, std::uint16_t least_port,
                                       const std::string& form);

/// Options bound to a value of these types; a wrong text is told with `form`, for example "U,V in
/// px".
CLI::Option* addEndpoint(CLI::App& app, const std::string& name, Endpoint& value,
                         std::uint16_t least_port, const std::string& form,
                         const std::string& help);

/// An option of two numbers "A,B"; `set_pair` returns false for a pair that is not allowed.
CLI::Option* addPair(CLI::App& app, const std::string& name,
                     const std::function<bool(const Vec2&)>& set_pair, const std::string& form,
                     const std::string& help);

/// What is said of a `text` that is no number from `least` to `most`. For double and
/// std::uint64_t.
template <class Number>
CLI::ValidationError notANumber(const std::string& name, const std::string& text, Number least,
                                Number most);

/// A finite number from `least` to `most`; `unit` is for the help. A Value takes a Number.
template <class Value, class Number>
CLI::Option* addNumber(CLI::App& app, const std::string& name, Value& value, Number least,
                       Number most, const std::string& unit, const std::string& help) {
  const auto set = [&value, name, least, most](const std::string& text) {
    const auto number = parseNumberInRange<Number>(text, least, most);
    if (!number) throw notANumber(name, text, least, most);
    value = *number;
  };
  return app.add_option_function<std::string>(name, set, help)->type_name(unit);
}

/// An option that may be repeated, each time with one value; `parse` tells nullopt of a text that
/// is none.
template <class Value>
CLI::Option* addList(CLI::App& app, const std::string& name, std::vector<Value>& values,
                     std::optional<Value> (*parse)(const std::string&), const std::string& help,
                     const std::string& form) {
  const auto set = [&values, parse, name, form](const std::vector<std::string>& texts) {
    values.clear();
    for (const std::string& text : texts) {
      const auto value = parse(text);
      if (!value) throw CLI::ValidationError(name, quote(text) + " is not " + form);
      values.push_back(*value);
    }
  };
  return app.add_option_function<std::vector<std::string>>(name, set, help)
      ->type_name(form.substr(0, form.find(' ')))
      ->allow_extra_args(false);
}

/// One of the named `choices` (which have to outlive `app`).
template <class Value>
CLI::Option* addChoice(CLI::App& app, const std::string& name, Value& value,
                       const std::map<std::string, Value>& choices, const std::string& help) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& choice : choices) words.push_back(choice.first);
  const std::string names = join(words, "|");
  const auto set = [&value, &choices, name, names, words](const std::string& text) {
    const auto found = choices.find(text);
    if (found == choices.end()) {
      throw CLI::ValidationError(
          name, quote(text) + " is not one of " + names + spellingHint(text, words));
    }
    value = found->second;
  };
  return app.add_option_function<std::string>(name, set, help)->type_name(names);
}

}  // namespace hapticast
