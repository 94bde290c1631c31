// SPDX-License-Identifier: MIT
#include "common/cli/subcommands.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "common/text.hpp"

namespace hapticast {

namespace {

/// Returns the place of `flag` in `arguments`; their end: it is not there.
template <class Arguments>
auto findFlag(Arguments& arguments, std::string_view flag) {
  return std::find_if(arguments.begin(), arguments.end(), [flag](const std::string& word) {
    return word.substr(0, word.find('=')) == flag;
  });
}

/// Returns the value of `flag` in `arguments`; nullopt: the flag is not there. A switch by itself
/// has the value "true". A flag at the end has an empty value.
std::optional<std::string> findValue(const std::vector<std::string>& arguments,
                                     std::string_view flag, bool is_switch) {
  const auto found = findFlag(arguments, flag);
  if (found == arguments.end()) return std::nullopt;
  if (found->size() > flag.size()) return found->substr(flag.size() + 1);
  if (is_switch) return "true";
  return found + 1 == arguments.end() ? "" : *(found + 1);
}

/// Returns whether `value` switches a flag off.
bool isOff(const std::string& value) {
  const std::string word = toLower(value);
  return word == "false" || word == "off" || word == "no" || word == "n" || word == "f" ||
         word == "0" || word == "-";
}

/// Returns whether the flag `each` with `value` chooses its subcommand.
bool isChosen(const SubcommandFlag& each, const std::string& value, bool is_switch) {
  return value.starts_with(each.prefix) && !(is_switch && isOff(value));
}

/// Moves `flag` with its value to the front of `arguments`, unless the value is missing.
void moveToFront(std::vector<std::string>& arguments, std::string_view flag, bool is_switch) {
  const auto begin = findFlag(arguments, flag);
  const bool is_next = !is_switch && begin->size() == flag.size();
  if (is_next && (begin + 1 == arguments.end() || (begin + 1)->starts_with("--"))) return;
  std::rotate(arguments.begin(), begin, begin + (is_next ? 2 : 1));
}

/// Returns the place of the first argument that is neither a flag of the program, such as --quiet,
/// nor its value.
std::vector<std::string>::iterator findFirst(const CLI::App& app,
                                             std::vector<std::string>& arguments) {
  auto at = arguments.begin();
  while (at != arguments.end() && at->starts_with("--")) {
    const CLI::Option* const option = app.get_option_no_throw(at->substr(0, at->find('=')));
    if (option == nullptr) break;
    const bool is_next = option->get_items_expected_min() > 0 && at->find('=') == std::string::npos;
    at += is_next && at + 1 != arguments.end() ? 2 : 1;
  }
  return at;
}

/// Returns the lines of the config file; none if it cannot be read, or can be read only once.
std::vector<KeyValue> readConfig(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::Option* const option = app.get_config_ptr();
  if (option == nullptr) return {};
  const auto given = findValue(arguments, "--config", false);
  const std::string file = given ? *given : option->get_default_str();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  std::ifstream in(file);
  auto pairs = readKeyValues(in, file);
  return pairs.ok() ? std::move(pairs).value() : std::vector<KeyValue>();
}

bool isSwitch(const CLI::App& app, const SubcommandFlag& each) {
  const CLI::App& chosen = findSubcommand(app, each.subcommand);
  return chosen.get_option_no_throw(std::string(each.flag))->get_items_expected_min() == 0;
}

/// Returns the subcommand that a key of the config file chooses; empty: none does. `first`: the
/// first argument; a source there wins over the file.
std::string_view findInConfig(const CLI::App& app, const SubcommandChoice& choice,
                              const std::vector<std::string>& arguments, const std::string& first) {
  const std::vector<KeyValue> pairs = readConfig(app, arguments);
  for (const SubcommandFlag& each : choice.flags) {
    const bool is_given = !each.prefix.empty() && !first.empty() && !first.starts_with('-');
    if (is_given || findFlag(arguments, each.flag) != arguments.end()) continue;
    const bool chooses = std::any_of(pairs.begin(), pairs.end(), [&](const KeyValue& pair) {
      return pair.key == each.flag.substr(2) && isChosen(each, pair.value, isSwitch(app, each));
    });
    if (chooses) return each.subcommand;
  }
  return {};
}

/// Returns the subcommand that an argument chooses, and moves its flag to the front; empty: none
/// does.
std::string_view findInArguments(const CLI::App& app, const SubcommandChoice& choice,
                                 std::vector<std::string>& arguments, const std::string& first) {
  for (const SubcommandFlag& each : choice.flags) {
    if (!each.prefix.empty() && first.starts_with(each.prefix)) return each.subcommand;
    const bool is_switch = isSwitch(app, each);
    const auto value = findValue(arguments, each.flag, is_switch);
    if (!value || !isChosen(each, *value, is_switch)) continue;
    moveToFront(arguments, each.flag, is_switch);
    return each.subcommand;
  }
  return {};
}

}  // namespace

CLI::App& addSubcommand(CLI::App& program, const std::string& name,
                        const std::string& description) {
  CLI::App* const app = program.add_subcommand(name, description);
  app->fallthrough();
  app->footer("Flags of every subcommand: --quiet, --config, --print-config, --version (" +
              program.get_name() + " --help).");
  return *app;
}

std::vector<std::string> chooseSubcommand(const CLI::App& app, const SubcommandChoice& choice,
                                          std::vector<std::string> arguments) {
  if (choice.otherwise.empty()) return arguments;
  const auto place = findFirst(app, arguments);
  const std::string first = place == arguments.end() ? "" : *place;
  if (&findSubcommand(app, first) != &app) {
    std::rotate(arguments.begin(), place, place + 1);
    return arguments;
  }
  const bool wants_help = std::any_of(arguments.begin(), arguments.end(), [](const auto& word) {
    return word == "--help" || word == "-h" || word == "--help-all";
  });
  std::string_view name = findInArguments(app, choice, arguments, first);
  if (name.empty() && wants_help) return arguments;
  if (name.empty()) name = findInConfig(app, choice, arguments, first);
  if (name.empty()) name = choice.otherwise;
  arguments.insert(arguments.begin(), std::string(name));
  return arguments;
}

const CLI::App& findSubcommand(const CLI::App& app, std::string_view name) {
  for (const CLI::App* const each : app.get_subcommands({})) {
    if (each->get_name() == name) return *each;
  }
  return app;
}

std::string findOwner(const CLI::App& app, const std::string& name, const CLI::App& than) {
  for (const CLI::App* const each : app.get_subcommands({})) {
    if (each != &than && each->get_option_no_throw(name) != nullptr) return each->get_name();
  }
  return "";
}

}  // namespace hapticast
