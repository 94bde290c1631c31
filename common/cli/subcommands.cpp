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

bool isFlag(const std::string& word, std::string_view flag) {
  return word.substr(0, word.find('=')) == flag;
}

/// Returns the value of `flag` in `arguments`; nullopt: the flag is not there. A flag at the end
/// has an empty value.
std::optional<std::string> findValue(const std::vector<std::string>& arguments,
                                     std::string_view flag) {
  const auto found = std::find_if(arguments.begin(), arguments.end(),
                                  [flag](const auto& word) { return isFlag(word, flag); });
  if (found == arguments.end()) return std::nullopt;
  if (found->size() > flag.size()) return found->substr(flag.size() + 1);
  return found + 1 == arguments.end() ? "" : *(found + 1);
}

/// Moves `flag` with its value to the front of `arguments`, unless the value is missing.
void moveToFront(std::vector<std::string>& arguments, std::string_view flag, bool has_value) {
  const auto begin = std::find_if(arguments.begin(), arguments.end(),
                                  [flag](const auto& word) { return isFlag(word, flag); });
  const bool is_next = has_value && begin->size() == flag.size();
  if (is_next && (begin + 1 == arguments.end() || (begin + 1)->starts_with("--"))) return;
  std::rotate(arguments.begin(), begin, begin + (is_next ? 2 : 1));
}

/// Returns the lines of the config file; none if it cannot be read, or can be read only once.
std::vector<KeyValue> readConfig(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::Option* const option = app.get_config_ptr();
  if (option == nullptr) return {};
  const auto given = findValue(arguments, "--config");
  const std::string file = given ? *given : option->get_default_str();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  std::ifstream in(file);
  auto pairs = readKeyValues(in, file);
  return pairs.ok() ? std::move(pairs).value() : std::vector<KeyValue>();
}

/// Returns the subcommand that a key of the config file chooses; empty: none does.
std::string_view findInConfig(const CLI::App& app, const SubcommandChoice& choice,
                              const std::vector<std::string>& arguments) {
  const std::vector<KeyValue> pairs = readConfig(app, arguments);
  for (const SubcommandFlag& each : choice.flags) {
    if (findValue(arguments, each.flag)) continue;  // it wins over the file
    const std::string_view key = each.flag.substr(2);
    const bool chooses = std::any_of(pairs.begin(), pairs.end(), [&](const KeyValue& pair) {
      return pair.key == key && pair.value != "false" && pair.value.starts_with(each.prefix);
    });
    if (chooses) return each.subcommand;
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
  if (!arguments.empty() && &findSubcommand(app, arguments.front()) != &app) return arguments;
  std::string_view name;
  for (const SubcommandFlag& each : choice.flags) {
    const auto value = findValue(arguments, each.flag);
    if (!value || !value->starts_with(each.prefix)) continue;
    name = each.subcommand;
    const CLI::App& chosen = findSubcommand(app, std::string(name));
    const CLI::Option* const option = chosen.get_option_no_throw(std::string(each.flag));
    moveToFront(arguments, each.flag, option->get_items_expected_min() > 0);
    break;
  }
  const bool wants_help = std::any_of(arguments.begin(), arguments.end(), [](const auto& word) {
    return word == "--help" || word == "-h" || word == "--help-all";
  });
  if (name.empty() && wants_help) return arguments;
  if (name.empty()) name = findInConfig(app, choice, arguments);
  if (name.empty()) name = choice.otherwise;
  arguments.insert(arguments.begin(), std::string(name));
  return arguments;
}

const CLI::App& findSubcommand(const CLI::App& app, const std::string& name) {
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
