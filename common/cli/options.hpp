// SPDX-License-Identifier: MIT
// Typed options of the command line. One parser for each option reads the flag and the config key
// of the same name. All error messages have one form. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/cli/cli11.hpp"
#include "common/endpoint.hpp"
#include "common/geometry.hpp"
#include "common/text.hpp"

namespace hapticast {

/// Returns the two finite numbers in a text of the form "A,B". Returns nullopt for other texts.
std::optional<Vec2> parsePair(const std::string& text);

/// Returns the endpoint in `text`, as parseEndpoint() does, with missing parts from `otherwise`.
/// Throws CLI::ValidationError if `text` is invalid, or if its port is below `least_port`. The
/// error message has the flag `name` and the expected `form`.
[[nodiscard]] Endpoint parseEndpointOr(const std::string& text, const Endpoint& otherwise,
                                       const std::string& name, std::uint16_t least_port,
                                       const std::string& form);

/// Adds an option to `app` that parses an endpoint into `value`. Missing parts keep the values that
/// `value` has now. A port below `least_port` is an error. `form` is the expected text for error
/// messages, for example "HOST:PORT". `help` is the option's line in --help.
CLI::Option* addEndpoint(CLI::App& app, const std::string& name, Endpoint& value,
                         std::uint16_t least_port, const std::string& form,
                         const std::string& help);

/// Adds an option to `app` that parses [ADDR:]PORT into `value`. The default of ADDR is 127.0.0.1.
CLI::Option* addLocalPort(CLI::App& app, const std::string& name, std::optional<Endpoint>& value,
                          const std::string& help);
/// Adds the option --live, with `value` as addLocalPort() has.
CLI::Option* addLive(CLI::App& app, std::optional<Endpoint>& value);

/// Adds an option to `app` for two numbers "A,B", which the option passes to `set_pair`. If
/// `set_pair` returns false, because the numbers are outside the allowed range, the error message
/// states `form`.
CLI::Option* addPair(CLI::App& app, const std::string& name,
                     const std::function<bool(const Vec2&)>& set_pair, const std::string& form,
                     const std::string& help);

/// Returns the last of the names of an option, such as --replay of "FILE,--replay".
[[nodiscard]] std::string lastName(const std::string& names);

/// Returns the error message that `text`, the value of the flag `name`, is no number from `least`
/// to `most`. Number is double or std::uint64_t.
template <class Number>
CLI::ValidationError notANumber(const std::string& name, const std::string& text, Number least,
                                Number most);

/// Sets the default that writeConfig() shows for `option`.
void showDefault(CLI::Option& option, double value);

/// Adds an option to `app` that parses a finite number from `least` to `most` into `value`. `unit`
/// is the unit for --help. Value must be assignable from Number.
template <class Value, class Number>
CLI::Option* addNumber(CLI::App& app, const std::string& name, Value& value, Number least,
                       Number most, const std::string& unit, const std::string& help) {
  const auto set = [&value, name = lastName(name), least, most](const std::string& text) {
    const auto number = parseNumberInRange<Number>(text, least, most);
    if (!number) throw notANumber(name, text, least, most);
    value = *number;
  };
  CLI::Option* const option = app.add_option_function<std::string>(name, set, help);
  if constexpr (std::is_arithmetic_v<Value>) {  // a value outside the range stands for "not set"
    if (value >= least && value <= most) showDefault(*option, static_cast<double>(value));
  }
  return option->type_name(unit);
}

/// Adds an option to `app` that the user may repeat, with one value each time. All values together
/// replace `values`. `parse` returns nullopt for an invalid text. `form` is the expected text for
/// error messages.
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

/// Adds an option to `app` whose text must be a key of `choices`. The option writes the value of
/// that key to `value`. `choices` must outlive `app`. `hint` returns what the error message adds
/// for an unknown text, for example "; did you mean touch?"; null: the key of the nearest spelling.
template <class Value>
CLI::Option* addChoice(CLI::App& app, const std::string& name, Value& value,
                       const std::map<std::string, Value>& choices, const std::string& help,
                       std::string (*hint)(const std::string& text) = nullptr) {
  std::vector<std::string> words;
  std::string present;
  words.reserve(choices.size());
  for (const auto& choice : choices) {
    words.push_back(choice.first);
    if (choice.second == value) present = choice.first;
  }
  const std::string names = join(words, "|");
  const auto set = [&value, &choices, name = lastName(name), names, words,
                    hint](const std::string& text) {
    const auto found = choices.find(text);
    if (found == choices.end()) {
      std::string meant = hint != nullptr ? hint(text) : "";
      if (meant.empty()) meant = spellingHint(text, words);
      throw CLI::ValidationError(name, quote(text) + " is not one of " + names + meant);
    }
    value = found->second;
  };
  return app.add_option_function<std::string>(name, set, help)
      ->type_name(names)
      ->default_str(present);
}

/// Adds an option to `app` that stores a file name in `file`. A name without the ending `ending`
/// (hasEnding()) is an error.
CLI::Option* addFile(CLI::App& app, const std::string& name, std::string& file,
                     const std::string& ending, const std::string& help);

/// Adds the flag --version, and appends the text of --version to --help. The text is "PROGRAM
/// VERSION (BUILT_IN)", where BUILT_IN is `built_in`. A second line has the optional packages of
/// this build. Thread: any.
void addVersion(CLI::App& app, const std::string& built_in);

/// An error in a config file. Its message lacks the name of the file; the code that reports the
/// error writes the name before the message. The config file (--config FILE) has lines `key =
/// value` (readKeyValues()). Every flag is a key of the same name. For a list the file repeats the
/// key. Thread: main, at start-up.
class ConfigFileError : public CLI::ParseError {
 public:
  explicit ConfigFileError(const std::string& what)
      : CLI::ParseError("ConfigFileError", what, CLI::ExitCodes::ConfigError) {}
};

/// Adds the flags `--config FILE` and `--print-config`. The file may set every flag of `app`
/// and of its subcommands. A key of another subcommand than the present one is ignored. An unknown
/// key causes a ConfigFileError. Without the flag the program reads the file
/// `default_file`, if it exists. Call it after all other flags were added.
void addConfigFile(CLI::App& app, const std::string& default_file = "");

/// Returns the text of a config file with each flag of `app` and of its subcommands, and its
/// default as a comment.
[[nodiscard]] std::string writeConfig(const CLI::App& app);

}  // namespace hapticast
